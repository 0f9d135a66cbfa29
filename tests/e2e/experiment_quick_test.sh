# The smallest of the project's own experiments, from the tracker's own start to the table next to the thesis'.
source "$(dirname "$0")/checks.sh"

# Each of the project's experiments can be read.
experiments=$(dirname "$0")/../../experiments
"$silpose" experiment --list >list.txt || fail "--list: exit $?"
for file in "$experiments"/*.toml; do
  grep -q "^$(basename "$file" .toml) .* runs" list.txt || fail "$file: not listed: $(cat list.txt)"
done

"$silpose" experiment human-synthetic --quick --out out --json --quiet >out.json || fail "exit $?"
[[ $(number out.json experiments human-synthetic runs) == 4 ]] || fail "not four runs: $(cat out.json)"
results=out/human-synthetic/results.json
expect_at_most "$(number $results figures 26/side/error_2d_px mean)" 8 "2D error of a bending elbow, px"
grep -q '"thesis_side_px": 25.51' $results || fail "the thesis' number is not next to ours"
for file in table-5.1.csv pixels.svg npsu.svg frames.svg; do
  [[ -s out/human-synthetic/$file ]] || fail "no $file"
done
finish
