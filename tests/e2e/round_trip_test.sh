# A short sequence with known truth is rendered, tracked and scored; the files are those that the documents promise.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --motion sway --amplitude-deg 15 --frames 8 --size 320x240 --seed 3 --quiet --json >synth.json
for file in poses.csv poses_normalised.csv joints.csv camera.toml run.json masks/000000.png masks/000007.png; do
  [[ -s truth/$file ]] || fail "synth did not write $file"
done
[[ $(wc -l <truth/poses.csv) == 9 ]] || fail "poses.csv has not one row a frame"

track=(track truth/masks --segmenter masks --camera truth/camera.toml --init truth/poses.csv --particles 100 --layers 4 --quiet)
"$silpose" "${track[@]}" --out one --threads 1 --json >one.json
"$silpose" "${track[@]}" --out two --threads 2 --json >two.json
for file in poses.csv poses_normalised.csv spread.csv joints.csv camera.toml overlay.mp4 report.html config.toml run.json \
            motion.bvh masks/000000.png; do
  [[ -s one/$file ]] || fail "track did not write $file"
done
for file in poses.csv poses_normalised.csv spread.csv joints.csv motion.bvh; do
  cmp -s "one/$file" "two/$file" || fail "$file differs between one thread and two"
done
[[ ! -e one.partial ]] || fail "one.partial is left behind"
[[ $(number one.json frames) == 8 && $(number one.json frames_tracked) == 8 ]] || fail "not every frame was tracked"
expect_at_least "$(number one.json visual_accuracy mean)" 0.80 "visual accuracy"
for stage in decode segment propagate likelihood resample write; do number one.json stages_s "$stage" >stage.txt || fail "no $stage"; done
grep -q '<video' one/report.html || fail "the report shows no video"
! grep -q -E 'https?:' one/report.html || fail "the report needs the network"
for file in poses.csv joints.csv motion.bvh markers.trc motion.mot motion.glb; do
  grep -q "\"$file\"" one/report.html || fail "the report does not name $file"
done
(($(grep -o 'data:image/jpeg;base64,[^"]' one/report.html | wc -l) == 8)) || fail "the report shows not eight masks"

"$silpose" evaluate --result one --truth truth --json --quiet >errors.json
[[ $(number errors.json frames) == 8 && $(number errors.json frames_missing) == 0 ]] || fail "evaluate lost frames"
expect_at_most "$(number errors.json joint_error_root_mm mean)" 120 "joint error, root aligned, mm"
expect_at_most "$(number errors.json joint_error_px mean)" 12 "joint error, px"
expect_at_least "$(number errors.json visual_accuracy mean)" 0.80 "visual accuracy against the truth"
expect_at_least "$(number errors.json mask_iou mean)" 0.999 "given masks against the truth's"

# The truth against itself is without error, and angles alone are enough for the angles.
"$silpose" evaluate --result truth --truth truth --json --quiet >zero.json
expect_at_most "$(number zero.json pose_error_deg mean)" 0.001 "error of the truth"
expect_at_most "$(number zero.json joint_error_mm mean)" 0.01 "error of the truth"

# The options of a run are written down and lead to the same result.
"$silpose" track truth/masks --config one/config.toml --out again --quiet
cmp -s one/poses.csv again/poses.csv || fail "config.toml does not lead to the same poses"

# An earlier result is replaced; another seed gives other particles.
"$silpose" "${track[@]}" --out two --seed 2
cmp -s one/poses.csv two/poses.csv && fail "the seed does nothing"

# Colour video, background learned from the clip itself, and masks from it.
"$silpose" synth --out colour --colour --lead-in 10 --motion circle --frames 10 --size 320x240 --quiet
"$silpose" segment colour/video.mp4 --background lead-in:0.33 --out masks --quiet --json >segment.json
[[ -s masks/masks/000019.png ]] || fail "segment wrote no masks"
"$silpose" track colour/video.mp4 --background lead-in:0.33 --camera colour/camera.toml --init colour/poses.csv \
  --particles 60 --layers 3 --out seen --quiet --json >seen.json
[[ $(number seen.json frames) == 10 ]] || fail "the lead-in is tracked"
grep -q '^10,' seen/poses.csv || fail "frame numbers do not count from the video's first image"

# Nothing said about the background: the network knows a person when it sees one, even a rendered one.
"$silpose" segment colour/video.mp4 --out learned --quiet --json >learned.json
grep -q '"background": "learned"' learned.json || fail "the person is not cut out by the network"
[[ $(number learned.json frames_empty) == 10 ]] || fail "somebody was seen in the lead-in, or nobody after it"
"$silpose" segment colour/video.mp4 --out learned --threads 1 --quiet && "$silpose" segment colour/video.mp4 --out again --quiet
cmp -s learned/masks/000019.png again/masks/000019.png || fail "another number of threads makes another mask"

# Masks keep the numbers of their names, with the video and by themselves.
for input in 'colour/video.mp4 --masks masks/masks' 'masks/masks --segmenter masks'; do
  "$silpose" segment $input --out given --quiet --json >given.json || fail "segment $input: exit $?"
  [[ $(number given.json frames) == 10 ]] || fail "segment $input: not ten frames"
  cmp -s masks/masks/000010.png given/masks/000010.png || fail "segment $input: the masks have other numbers"
done
"$silpose" evaluate --result seen --truth colour --json --quiet >seen_errors.json
expect_at_least "$(number seen_errors.json mask_iou mean)" 0.65 "segmented masks"

# No person: a result that says so.
"$silpose" track colour/video.mp4 --background lead-in:0.33 --region 0,0,8,8 --out nobody --quiet --json >nobody.json
[[ $(number nobody.json frames_tracked) == 0 ]] || fail "somebody was tracked where nobody is"
grep -q -i 'no person' nobody.json || fail "no warning that nobody was seen"
[[ -s nobody/report.html && -s nobody/poses.csv ]] || fail "no result where nobody is seen"

# One pose as an image, and bodies.
for kind in silhouette depth shaded; do
  "$silpose" render --pose truth/poses.csv:3 --kind $kind --size 200x160 --out $kind.png --quiet || fail "render --kind $kind"
  [[ -s $kind.png ]] || fail "no $kind.png"
done
"$silpose" model lod --vertices 1500 --out small.body --quiet
"$silpose" model inspect small.body --json >small.json
[[ $(number small.json closed) == True && $(number small.json dofs) == 37 ]] || fail "the coarse body is not whole"
"$silpose" model lod --out levels.body --quiet
"$silpose" model lod --model levels.body --iou 0.975 --out chosen.body --quiet
"$silpose" model inspect chosen.body --json >chosen.json
chosen=$(number chosen.json vertices)
((chosen > 500 && chosen < 2500)) || fail "$chosen vertices for an overlap of 0.975"
"$silpose" "${track[@]}" --model levels.body --iou 0.975 --out by_iou --json >by_iou.json || fail "track --iou"
grep -q -x 'vertices = 1250' by_iou/config.toml || fail "config.toml does not say which level --iou took"
refusal=$("$silpose" model lod --model levels.body --iou 0.9999 --out none.body --quiet 2>&1) && fail "a level that is not there"
grep -q 'no level of detail' <<<"$refusal" || fail "no word on the level that is not there: $refusal"

finish
