# Experiments: listed, run, stopped and resumed, refused where something else lies.
source "$(dirname "$0")/checks.sh"

"$silpose" experiment --list >list.txt
for name in human-synthetic human-motion human-start human-robust human-faults human-cameras human-cost real; do
  grep -q "^$name " list.txt || fail "--list does not show $name: $(cat list.txt)"
done

# A user's description: small enough to be done in a moment.
cat >sweeps.toml <<'TOML'
title = "Two elbows"
seeds = 2
[run]
frames = 2
period_s = 2.7
size = [160, 120]
focal_px = 175
preset = "thesis"
particles = 50
start = "truth"
[[axis]]
name = "dof"
key = "motion"
values = ["dof:26", "dof:33"]
[[table]]
name = "errors"
title = "Errors"
rows = ["dof"]
figures = ["joint_error_mm", "pose_error_npsu"]
[[plot]]
name = "errors"
x = "dof"
figure = "joint_error_mm"
TOML
"$silpose" experiment sweeps.toml --out out >text.txt 2>err.txt || fail "exit $?: $(cat err.txt)"
grep -q '^dof:26 ' text.txt || fail "the main table is not printed: $(cat text.txt)"
for file in results.json runs.csv frames.csv errors.csv errors.svg; do
  [[ -s out/sweeps/$file ]] || fail "no $file"
done
[[ ! -e out.partial && ! -e out/sweeps/runs ]] || fail "something is left over"
[[ $(number out/sweeps/results.json figures dof:26/joint_error_mm n) == 2 ]] || fail "not two seeds"
[[ $(wc -l <out/sweeps/runs.csv) == 5 ]] || fail "not four runs: $(cat out/sweeps/runs.csv)"

# Stopped, and resumed to the same frames. Another experiment in the same directory stays.
sed -i 's/^frames = 2/frames = 40/' sweeps.toml
"$silpose" experiment sweeps.toml --out whole --json --quiet >/dev/null
cp sweeps.toml stopped.toml
status=0
"$silpose" experiment stopped.toml --out out --quiet >/dev/null 2>err.txt &
process=$!
for ((wait = 0; wait < 300; ++wait)); do
  compgen -G 'out.partial/stopped/runs/*.json' >/dev/null && break
  sleep 0.02
done
kill -INT $process 2>/dev/null || true
wait $process || status=$?
[[ $status == 130 ]] || fail "exit $status, not 130: $(cat err.txt)"
[[ -e out/sweeps/results.json ]] || fail "the other experiment is gone"
first=$(find out.partial/stopped/runs -mindepth 1 -printf "%f\n" -quit)
before=$(stat -c %Y.%i "out.partial/stopped/runs/$first")
cp -r out.partial kept.partial
"$silpose" experiment stopped.toml --out kept --resume --quiet >/dev/null || fail "--resume: exit $?"
[[ $(stat -c %Y.%i "out.partial/stopped/runs/$first") == "$before" ]] || fail "the finished run was touched"
cmp -s kept/stopped/frames.csv whole/sweeps/frames.csv || fail "resumed to other frames"

# A clip rendered here, in the layout of recorded ones.
mkdir clips
"$silpose" synth --motion sway --frames 4 --size 160x120 --out clips/sway --quiet >/dev/null || fail "synth: exit $?"
cat >recorded.toml <<'TOML'
title = "One clip"
seeds = 2
[run]
clip = ["sway/masks"]
camera = "sway/camera.toml"
truth = "sway"
segmenter = "masks"
[[axis]]
name = "evidence"
key = "evidence"
values = ["silhouette", "both"]
[[table]]
name = "errors"
rows = ["evidence"]
figures = ["joint_error_root_mm", "knee_error_deg", "coverage_knee", "risk_40_mm", "observed_iou"]
TOML
"$silpose" experiment recorded.toml --data clips --out recorded --quiet >text.txt 2>err.txt || fail "exit $?: $(cat err.txt)"
expect_at_most "$(number recorded/recorded/results.json figures both/joint_error_root_mm mean)" 150 "error of a clip, mm"
for score in worst_frame_mm ece_joint rank_correlation coverage_joint visual_accuracy frames_per_second; do
  grep -q "\"silhouette/$score\"" recorded/recorded/results.json || fail "no $score"
done
expect_failure 1 'recorded: needs recorded clips .*--data' experiment recorded.toml --out x
expect_failure 1 'nowhere/sway/masks: no such file' experiment recorded.toml --out x --data nowhere
sed 's/^segmenter/motion = "sway"\nsegmenter/' recorded.toml >mixed.toml
expect_failure 1 'mixed.toml: run.motion: not together with clip' experiment mixed.toml --out x --data clips
expect_failure 1 'real: needs recorded clips .*--data' experiment real --out x

expect_failure 1 'no-such: no such experiment \(.*human-motion' experiment no-such --out x
expect_failure 1 'human-motion: needs motion-capture files .*--data' experiment human-motion --out x
expect_failure 1 'nowhere/.*: no such file' experiment human-motion --out x --data nowhere
expect_failure 2 'NAME is missing' experiment --out x
expect_failure 2 '--out is missing' experiment human-start
mkdir mine && echo hello >mine/letter.txt
expect_failure 1 'mine: holds something other .*letter.txt' experiment sweeps.toml --out mine
sed 's/^frames = 40/frames = -1/' sweeps.toml >broken.toml
expect_failure 1 'broken.toml: run.frames: ' experiment broken.toml --out x
finish
