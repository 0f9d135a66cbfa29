# silpose_bench: one object of figures, what is wrong with a command line, curves that cannot be written.
source "$(dirname "$0")/checks.sh"
bench=$3

"$bench" --json --rounds 3 xor_128_us xor_256_us >figures.json || fail "XOR counts: exit $?"
for name in xor_128_us xor_256_us; do
  for figure in value peer_value ratio; do
    expect_at_least "$(number figures.json $name $figure)" 1e-6 "$name, $figure"
  done
  expect_at_least "$(number figures.json $name spread)" 0 "$name, spread"
done
python3 - figures.json <<'PYTHON' || fail "not the figures that were asked for"
import json
import sys

figures = json.load(open(sys.argv[1]))
assert list(figures) == ["xor_128_us", "xor_256_us"], figures
for figure in figures.values():
    assert list(figure) == ["value", "unit", "peer", "peer_value", "ratio", "processor_ratio", "spread", "others"], figure
    assert figure["unit"] == "us" and figure["peer"].startswith("scalar popcount"), figure
    assert len(figure["others"]) == 1, figure
PYTHON

"$bench" --json --rounds 1 metric_surface_s >surface.json || fail "metric surface: exit $?"
expect_at_least "$(number surface.json metric_surface_s value)" 1e-3 "metric surface, seconds"

for arguments in "nonsense" "--rounds 0 xor_128_us" "--rounds many"; do
  status=0
  # shellcheck disable=SC2086
  "$bench" --json $arguments >out.txt 2>err.txt || status=$?
  [[ $status == 2 ]] || fail "silpose_bench $arguments: exit $status, not 2"
  [[ $(wc -l <err.txt) == 1 ]] || fail "silpose_bench $arguments: not one line on stderr: $(cat err.txt)"
  grep -q '^{"error":' out.txt || fail "silpose_bench $arguments: no error object on stdout"
done
touch file
status=0
"$bench" --curves file/curves --rounds 1 2>err.txt || status=$?
[[ $status == 1 ]] && grep -q 'file/curves' err.txt || fail "--curves below a file: exit $status, $(cat err.txt)"
finish
