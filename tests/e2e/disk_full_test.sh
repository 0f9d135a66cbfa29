# Files that may not grow, as on a full disk: one line, exit 1, the earlier result untouched, nothing half written left.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --colour --motion static --frames 3 --size 160x120 --quiet >log.txt
cp -r truth result
find result -type f -exec sha256sum {} + | sort >before.txt

# full NAME ARGUMENT...: under larger and larger limits silpose fails as it should, each time at another file, until it
# has room.
full() {
  local name=$1 limit status failed=0
  shift
  for limit in 0 1 4 8 12 64 16384; do
    status=0
    (ulimit -f $limit && exec "$silpose" "$@" --quiet 2>&1) | cat >err.txt || status=$?
    [[ $status == 0 ]] && break
    failed=$((failed + 1))
    [[ $status == 1 ]] || fail "$name, $limit KiB: exit $status: $(cat err.txt)"
    [[ $(grep -c -v '^silpose: warning: ' err.txt) == 1 ]] || fail "$name, $limit KiB: not one line: $(cat err.txt)"
    grep -q -E 'result.*(cannot be written|not writable)' err.txt || fail "$name, $limit KiB: $(cat err.txt)"
    [[ -z $(find . -name '*.partial*' -o -name '*.tmp' -o -name '*.old-*') ]] || fail "$name, $limit KiB: something is left"
    find result -type f -exec sha256sum {} + | sort >after.txt
    cmp -s before.txt after.txt || fail "$name, $limit KiB: the earlier result was touched"
    grep -o '[a-z_]*\.[a-z0-9]*[: ]' err.txt | tail -1 >>places.txt
  done
  [[ $status == 0 && $failed -ge 1 ]] || fail "$name: exit $status after $failed failures: $(cat err.txt)"
  rm -r result && cp -r truth result
}
full track track truth/video.mp4 --masks truth/masks --camera truth/camera.toml --particles 10 --layers 1 --out result
full segment segment truth/video.mp4 --segmenter background --out result
full synth synth --colour --motion static --frames 3 --size 160x120 --out result
sort places.txt | uniq -c
finish
