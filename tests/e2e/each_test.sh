# A folder of clips in one command: one result each, failures listed at the end, the rest done; resumed later.
source "$(dirname "$0")/checks.sh"

for seed in 1 2; do
  "$silpose" synth --out "truth$seed" --motion sway --amplitude-deg 10 --frames 2 --size 160x120 --seed $seed --quiet
  cp -r "truth$seed/masks" "clip$seed"
done
echo "no film" >broken.mp4
each=(track --each --segmenter masks --camera truth1/camera.toml --vertices 600 --hypotheses 1 --out all)

found=0
"$silpose" "${each[@]}" clip1 broken.mp4 clip2 --quiet --json >out.json 2>err.txt || found=$?
[[ $found == 1 ]] || fail "a broken clip among others: exit $found"
[[ $(grep -c broken.mp4 err.txt) == 1 ]] || fail "the broken clip is not reported once: $(cat err.txt)"
for clip in clip1 clip2; do
  [[ -s all/$clip/poses.csv && -s all/$clip/run.json ]] || fail "no result of $clip"
  grep -q -x "video = '$clip'" all/$clip/config.toml || fail "config.toml of $clip names another video"
  ! grep -q each all/$clip/config.toml || fail "config.toml of $clip says --each"
done
[[ ! -e all/broken && ! -e all/broken.partial ]] || fail "the broken clip left something"
grep -q '"error"' out.json || fail "--json does not say what failed"
"$silpose" track --config all/clip2/config.toml --out again --quiet || fail "--config of one of them: exit $?"
cmp -s all/clip2/poses.csv again/poses.csv || fail "clip2 by itself has other poses"

touch -d @1000000000 all/clip1/poses.csv
rm -r all/clip2
"$silpose" "${each[@]}" clip1 clip2 --resume >resumed.txt 2>/dev/null || fail "--resume: exit $?"
grep -q '1 of 2 clips tracked, 1 were there already' resumed.txt || fail "--resume says: $(cat resumed.txt)"
[[ $(stat -c %Y all/clip1/poses.csv) == 1000000000 ]] || fail "--resume tracked again what was there"
[[ -s all/clip2/poses.csv ]] || fail "--resume left out what was not there"

expect_failure 2 'one name' "${each[@]}" clip1 truth1/../clip1
expect_failure 2 'live' "${each[@]}" camera:0
expect_failure 2 'masks: belong to one clip' "${each[@]}" clip1 --masks clip2
finish
