# Sourced by the scripts next to it: a long command that reports its progress every 10 s.

readonly kHeartbeat_s=10

# with_heartbeat LOG SUMMARY COMMAND [ARGUMENT...]
# Runs COMMAND with all its output in LOG. Prints, every 10 s, the seconds so far and what `SUMMARY LOG` prints (a
# function below). Returns the exit status of COMMAND.
with_heartbeat() {
  local log=$1 summary=$2 started=$SECONDS status=0 beat line
  shift 2
  : >"$log"
  # COMMAND stays in the foreground, so that Ctrl-C and password prompts reach it. The loop ends with this script, too;
  # its sleep holds no output open.
  while sleep "$kHeartbeat_s" </dev/null >/dev/null 2>&1 && kill -0 $$ 2>/dev/null; do
    line=$("$summary" "$log")
    echo "  $((SECONDS - started)) s${line:+: $line}"
  done &
  beat=$!
  "$@" >>"$log" 2>&1 || status=$?
  kill "$beat" 2>/dev/null || true
  wait "$beat" 2>/dev/null || true
  return "$status"
}

# The last line, cut; of lines that were overwritten, the last as well.
last_line() {
  tail -n 1 "$1" | tr '\r' '\n' | tail -n 1 | cut -c 1-110
}

# Share and estimate of a build by ninja, whose lines begin with kNinjaStatus.
readonly kNinjaStatus='[%f/%t %e s] '
build_share() {
  awk -F '[][/ ]' '
    /^\[[0-9]+\/[0-9]+ [0-9.]+ s\] / { done = $2; all = $3; seconds = $4 }
    END {
      if (done > 0) {
        left = seconds * (all - done) / done
        printf "%d of %d steps built (%d %%), about %d s left\n", done, all, 100 * done / all, left
      } else {
        print "first steps"
      }
    }' "$1"
}

# What a build by ninja printed besides its progress: warnings, errors, and the commands that failed.
without_progress() {
  grep -vE '^\[[0-9]+/[0-9]+ [0-9.]+ s\] ' "$1" || true
}
