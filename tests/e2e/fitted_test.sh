# The fitted trackers: presets accurate and default, what was used is written down and leads to the same files; Ctrl-C
# while a clip is smoothed.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --motion sway --amplitude-deg 15 --frames 6 --size 320x240 --seed 3 --quiet
track=(track truth/masks --segmenter masks --camera truth/camera.toml --quiet --json)

"$silpose" "${track[@]}" --preset accurate --threads 1 --out accurate >accurate.json || fail "accurate: exit $?"
for file in poses.csv poses_normalised.csv spread.csv joints.csv camera.toml overlay.mp4 report.html config.toml run.json \
            motion.bvh masks/000000.png masks/000005.png; do
  [[ -s accurate/$file ]] || fail "accurate: no $file"
done
[[ $(number accurate.json frames) == 6 && $(number accurate.json frames_tracked) == 6 ]] || fail "not every frame was tracked"
expect_at_least "$(number accurate.json stages_s smooth)" 0.001 "seconds of smoothing"
for stage in decode segment propagate likelihood resample write; do
  number accurate.json stages_s "$stage" >stage.txt || fail "no $stage"
done
expect_at_least "$(number accurate.json visual_accuracy mean)" 0.97 "visual accuracy, accurate"
"$silpose" evaluate --result accurate --truth truth --json --quiet >errors.json
expect_at_most "$(number errors.json joint_error_root_mm mean)" 60 "joint error, accurate, root aligned, mm"
for line in "preset = 'accurate'" 'smooth = true' 'floor = true' 'hypotheses = [0-9]*' 'vertices = 0'; do
  grep -q -x "$line" accurate/config.toml || fail "config.toml does not say $line"
done
! grep -q -E '^(particles|layers|metric|resample-below|sharpness)' accurate/config.toml ||
  fail "options of other trackers in config.toml"
"$silpose" track --config accurate/config.toml --threads 2 --out again --quiet || fail "--config: exit $?"
for file in poses.csv spread.csv joints.csv motion.bvh config.toml; do
  cmp -s accurate/$file again/$file || fail "$file differs when the options come from config.toml"
done

"$silpose" "${track[@]}" --hypotheses 2 --out two >two.json || fail "two hypotheses: exit $?"
expect_at_least "$(number two.json visual_accuracy mean)" 0.9 "visual accuracy, two hypotheses"
grep -q -x 'hypotheses = 2' two/config.toml || fail "config.toml does not say two hypotheses"
awk -F, 'NR > 1 && ($NF < 1 || $NF > 2.0001) { exit 1 }' two/poses.csv || fail "effective sample size is not within 1 and 2"
"$silpose" "${track[@]}" --preset accurate --no-smooth --no-floor --hypotheses 1 --vertices 1500 --end 0.04 --out one >one.json ||
  fail "--no-smooth --no-floor: exit $?"
grep -q -x 'smooth = false' one/config.toml || fail "config.toml does not say that nothing was smoothed"
grep -q -x 'floor = false' one/config.toml || fail "config.toml does not say that there is no floor"
"$silpose" track truth/masks --segmenter masks --end 0.04 --out assumed --quiet || fail "an assumed camera: exit $?"
grep -q -x 'floor = false' assumed/config.toml || fail "an assumed camera has a floor"
"$silpose" "${track[@]}" --particles 200 --layers 1 --metric coverage --end 0.1 --out plain >plain.json || fail "plain filter: exit $?"
grep -q -x 'layers = 1' plain/config.toml || fail "config.toml does not say one layer"
grep -q -x "metric = 'coverage'" plain/config.toml || fail "config.toml does not say the metric"
"$silpose" track --config plain/config.toml --out again --quiet || fail "--config of a plain filter: exit $?"
cmp -s plain/poses.csv again/poses.csv || fail "plain filter: other poses when the options come from config.toml"

# Two cameras and a body that is 6 % too short: its bones are fitted.
"$silpose" synth --out pair --model human:height=1.75 --motion sway --amplitude-deg 20 --frames 4 --size 320x240 --view 30 \
  --view 120 --seed 3 --quiet
pair=(track pair/masks_30 pair/masks_120 --segmenter masks --camera pair/camera.toml --camera-name 30 --camera-name 120
      --preset accurate --model human:height=1.65 --vertices 1000 --hypotheses 2 --quiet --json)
"$silpose" "${pair[@]}" --out pair_fitted >fitted.json || fail "--fit-body: exit $?"
"$silpose" "${pair[@]}" --no-fit-body --out pair_given >given.json || fail "--no-fit-body: exit $?"
[[ -s pair_fitted/fitted.body && ! -e pair_given/fitted.body ]] || fail "fitted.body is not where it should be"
expect_at_least "$(number fitted.json fitted lengths_m right_shin_length mean)" 0.01 "longer shin, metres"
grep -q -x 'fit-body = true' pair_fitted/config.toml || fail "config.toml does not say that the body was fitted"
grep -q -x 'fit-body = false' pair_given/config.toml || fail "config.toml does not say that the body was not fitted"
grep -q 'floor = true' pair_fitted/config.toml || fail "config.toml does not say that there is a floor"
cp -r pair_fitted pair_again
"$silpose" track --config pair_fitted/config.toml --out pair_again --quiet || fail "--config of a fitted body, over a result: exit $?"
for file in poses.csv joints.csv fitted.body config.toml; do
  cmp -s pair_fitted/$file pair_again/$file || fail "fitted body: $file differs when the options come from config.toml"
done
"$silpose" evaluate --result pair_fitted --truth pair --json --quiet >fitted_errors.json
"$silpose" evaluate --result pair_given --truth pair --json --quiet >given_errors.json
expect_at_most "$(number fitted_errors.json joint_error_mm mean)" "$(number given_errors.json joint_error_mm mean)" \
  "joint error with the fitted body, mm"

# The subject's own body: by two cameras, and her size by one that knows its floor.
"$silpose" model fit pair/masks_30 pair/masks_120 --segmenter masks --camera pair/camera.toml --camera-name 30 \
  --camera-name 120 --model human:height=1.65 --out subject.body --quiet --json >subject.json || fail "model fit: exit $?"
expect_at_least "$(number subject.json fitted lengths_m right_shin_length mean)" 0.01 "longer shin, metres"
"$silpose" model inspect subject.body --quiet >/dev/null || fail "the fitted body cannot be read"
"$silpose" synth --out tall --model human:height=1.8 --motion static --frames 3 --size 320x240 --quiet
"$silpose" model fit tall/masks --segmenter masks --camera tall/camera.toml --model human:height=1.65 --out tall.body \
  --quiet --json >tall.json || fail "model fit with one camera: exit $?"
expect_at_least "$(number tall.json height_m)" 1.73 "height by the floor, metres"
expect_at_most "$(number tall.json height_m)" 1.87 "height by the floor, metres"

# Stopped while it smooths: the masks are whole and can be tracked later.
"$silpose" synth --out long --motion sway --frames 60 --size 160x120 --quiet
cp -r accurate stopped
status=0
"$silpose" track long/masks --segmenter masks --camera long/camera.toml --preset accurate --out stopped --quiet --json \
  >out.json 2>err.txt &
process=$!
for ((wait = 0; wait < 300; ++wait)); do
  [[ -e stopped.partial/masks/000059.png ]] && break
  sleep 0.05
done
sleep 0.2
kill -INT $process
wait $process || status=$?
[[ $status == 130 ]] || fail "exit $status, not 130: $(cat err.txt)"
grep -q 'interrupted.*stopped.partial' err.txt || fail "does not say where the masks are: $(cat err.txt)"
[[ -s stopped.partial/camera.toml && -s stopped.partial/run.json && ! -e stopped.partial/poses.csv ]] || fail "$(ls stopped.partial)"
cmp -s long/masks/000059.png stopped.partial/masks/000059.png || fail "the partial masks are not whole"
cmp -s accurate/poses.csv stopped/poses.csv || fail "the earlier result was touched"
finish
