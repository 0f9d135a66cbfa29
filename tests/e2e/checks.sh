# Sourced by the end-to-end tests: PROGRAM FOLDER on the command line; empties FOLDER and changes to it.
set -euo pipefail
silpose=$1
rm -rf "$2"
mkdir -p "$2"
cd "$2"
failures=0

fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

finish() {
  [[ $failures -eq 0 ]] || { echo "$failures checks failed" >&2; exit 1; }
  echo "all checks passed"
}

# expect_failure STATUS PATTERN ARGUMENT...: silpose exits with STATUS (a regular expression) and says one line that
# matches PATTERN on stderr; with --json it says the same as {"error": ...}.
expect_failure() {
  local status=$1 pattern=$2 found=0
  shift 2
  "$silpose" "$@" --quiet --json >out.txt 2>err.txt || found=$?
  [[ $found =~ ^($status)$ ]] || fail "silpose $*: exit $found, not $status: $(cat err.txt)"
  [[ $(grep -c -v '^silpose: warning: ' err.txt) == 1 ]] || fail "silpose $*: not one line on stderr: $(cat err.txt)"
  grep -q -i -E -- "$pattern" err.txt || fail "silpose $*: does not say '$pattern': $(cat err.txt)"
  grep -q '^{"error":' out.txt || fail "silpose $*: no error object on stdout: $(cat out.txt)"
}

# expect_at_least NUMBER LEAST WHAT and expect_at_most.
expect_at_least() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a + 0 >= b + 0) }' || fail "$3: $1 is below $2"; }
expect_at_most() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 <= b + 0) }' || fail "$3: $1 is above $2"; }

# number FILE KEY [KEY]: a number of a JSON object that silpose printed, two levels deep at most.
number() {
  python3 - "$@" <<'PYTHON'
import json
import sys

value = json.load(open(sys.argv[1]))
for key in sys.argv[2:]:
    value = value[key]
print(value)
PYTHON
}
