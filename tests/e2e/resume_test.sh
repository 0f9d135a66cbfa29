# --resume: an interrupted or killed track is resumed, to the same bytes as if it had never been stopped; what cannot be
# resumed is reported in one line, and nothing of it is lost.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --colour --motion sway --frames 24 --lead-in 6 --size 160x120 --seed 3 --quiet
small=(--camera truth/camera.toml --vertices 600 --hypotheses 2)
tables=(poses.csv poses_normalised.csv spread.csv joints.csv motion.bvh markers.trc)

# stop SIGNAL NAME FILE TRACK...: sends the signal once FILE is in NAME.partial; exit 130 of Ctrl-C.
stop() {
  local signal=$1 name=$2 file=$3 status=0 wait
  shift 3
  "$silpose" track "$@" --out "$name" --quiet >/dev/null 2>err.txt &
  local process=$!
  for ((wait = 0; wait < 1000; ++wait)); do
    [[ -e $name.partial/$file ]] && break
    sleep 0.02
  done
  kill -"$signal" $process || fail "$name: it was done before it could be stopped"
  wait $process 2>/dev/null || status=$?
  [[ $signal == KILL || $status == 130 ]] || fail "$name: exit $status, not 130: $(cat err.txt)"
  [[ ! -e $name && -s $name.partial/checkpoint.bin ]] || fail "$name: nothing to resume from: $(ls "$name"*)"
}

# same WHOLE NAME FILE...
same() {
  local whole=$1 name=$2 file
  shift 2
  for file in "$@"; do cmp -s "$whole/$file" "$name/$file" || fail "$name: another $file"; done
  diff -rq "$whole" "$name" | grep '^Only' && fail "$name: other files than in $whole"
  [[ ! -e $name.partial ]] || fail "$name.partial is left behind"
}

# Frame by frame: stopped twice, and killed.
online=(truth/video.mp4 --segmenter background --background lead-in:0.15 "${small[@]}" --draw-floor)
"$silpose" track "${online[@]}" --out whole --quiet
stop INT twice masks/000012.png "${online[@]}"
rows=$(($(wc -l <twice.partial/poses.csv) - 1))
[[ $rows -ge 5 && $rows -lt 24 ]] || fail "$rows rows in the partial poses.csv"
stop INT twice masks/000020.png "${online[@]}" --resume
"$silpose" track "${online[@]}" --resume --threads 1 --out twice >/dev/null 2>err.txt || fail "--resume: exit $?: $(cat err.txt)"
grep -q -E 'twice.partial: [0-9]+ frames are done; resuming after frame [0-9]+' err.txt || fail "does not say where it resumes: $(cat err.txt)"
same whole twice "${tables[@]}" camera.toml config.toml masks/000006.png masks/000029.png overlay.mp4

# One of many clips.
"$silpose" track --each "${online[@]}" --out all --quiet >/dev/null 2>err.txt &
process=$!
for ((wait = 0; wait < 1000; ++wait)); do
  [[ -e all/video.partial/masks/000012.png ]] && break
  sleep 0.02
done
kill -INT $process
wait $process && fail "--each: was not stopped"
"$silpose" track --each "${online[@]}" --resume --out all >/dev/null 2>err.txt || fail "--each --resume: exit $?"
grep -q 'all/video.partial: .* frames are done' err.txt || fail "--each does not resume within a clip: $(cat err.txt)"
same whole all/video "${tables[@]}"

# A clip that is tracked as a whole, killed in its passes; the body fitted to it, stopped.
whole=(truth/video.mp4 --segmenter background "${small[@]}" --preset accurate)
"$silpose" track "${whole[@]}" --out smooth --quiet
stop KILL killed checkpoint.bin "${whole[@]}"
cp -r killed.partial kept.partial
"$silpose" track "${whole[@]}" --resume --out killed --quiet || fail "--resume of what was killed: exit $?"
same smooth killed "${tables[@]}" overlay.mp4
"$silpose" track "${online[@]}" --resume --out fresh 2>err.txt >/dev/null || fail "--resume without anything: exit $?"
grep -q 'fresh.partial: nothing to resume from' err.txt || fail "does not say that it starts from the beginning: $(cat err.txt)"
same whole fresh poses.csv

"$silpose" synth --out pair --model human:height=1.75 --motion sway --frames 6 --size 160x120 --view 30 --view 120 --seed 3 --quiet
pair=(pair/masks_30 pair/masks_120 --segmenter masks --camera pair/camera.toml --camera-name 30 --camera-name 120
      --preset accurate --model human:height=1.65 --vertices 600 --hypotheses 1
      --garbage-mask garbage.pgm)
{ printf 'P5\n160 120\n255\n' && head -c 16000 /dev/zero | tr '\0' '\377' && head -c 3200 /dev/zero; } >garbage.pgm  # no feet
"$silpose" track "${pair[@]}" --out pair_whole --quiet
stop INT pair_again checkpoint.bin "${pair[@]}"
"$silpose" track "${pair[@]}" --resume --out pair_again --quiet || fail "--resume of a fitted body: exit $?"
same pair_whole pair_again "${tables[@]}" fitted.body

# The same without smoothing, stopped in the second pass. When that is, is found by bisection.
pair=("${pair[@]}" --no-smooth --fit-body)
began=$(date +%s%3N)
"$silpose" track "${pair[@]}" --out pair_online --quiet
early=0 late=$(($(date +%s%3N) - began)) place="nowhere"  # milliseconds
for ((attempt = 0; attempt < 40; ++attempt)); do
  ((late - early < 4)) && early=$((early / 2)) late=$((late * 3 / 2))  # the machine is slower or faster than it was
  ms=$(((early + late) / 2))
  rm -rf pair_again pair_again.partial
  timeout --signal=INT "$((ms / 1000)).$(printf %03d $((ms % 1000)))" \
    "$silpose" track "${pair[@]}" --out pair_again --quiet >/dev/null 2>&1 && late=$ms && continue
  [[ -e pair_again.partial/checkpoint.bin ]] || { early=$ms && continue; }
  "$silpose" track "${pair[@]}" --resume --out pair_again >/dev/null 2>err.txt || fail "--resume after $ms ms: exit $?"
  same pair_online pair_again "${tables[@]}" fitted.body
  place=$(grep -o 'resuming .*' err.txt) || fail "does not say where it resumes: $(cat err.txt)"
  [[ $place == "resuming after the fit of the body" ]] && break
  [[ $place == "resuming with the overlay" ]] && late=$ms || early=$ms
done
[[ $place == "resuming after the fit of the body" ]] || fail "not stopped in the second pass in $attempt tries; last: $place"

# A sampling filter, and a background that is learned on and on.
sampling=(truth/video.mp4 --background online --camera truth/camera.toml --particles 300 --layers 4)
"$silpose" track "${sampling[@]}" --out sampled --quiet
stop INT sampled_again masks/000015.png "${sampling[@]}"
"$silpose" track "${sampling[@]}" --resume --out sampled_again --quiet || fail "--resume of a sampling filter: exit $?"
same sampled sampled_again "${tables[@]}" masks/000029.png

# What cannot be resumed.
find kept.partial -type f -exec sha256sum {} + | sort >before.txt
refused() {
  expect_failure "$@" --resume --out kept
  find kept.partial -type f -exec sha256sum {} + | sort >after.txt
  cmp -s before.txt after.txt || fail "${*:2:1}: what was done was touched"
}
refused 1 'kept.partial can only be resumed as it was started; --hypotheses: was 2, now 3' track "${whole[@]/#2/3}"
refused 1 '--seed: was 1, now 7' track "${whole[@]}" --seed 7
refused 1 '--region: was not given, now' track "${whole[@]}" --region 0,0,160,120
cp truth/video.mp4 other.mp4
refused 1 'VIDEO: was .*video.mp4.*now .*other.mp4' track other.mp4 "${whole[@]:1}"
refused 2 'resume: camera:0 is live' track camera:0 "${whole[@]:1}" --no-smooth
sed 's/^translation = .*/translation = [0.0, 1.0, 5.0]/' truth/camera.toml >moved.toml
cp truth/camera.toml camera.toml
cp moved.toml truth/camera.toml
refused 1 'the cameras' track "${whole[@]}"
cp camera.toml truth/camera.toml
cp -r truth/video.mp4 video.mp4
"$silpose" synth --out other --colour --motion sway --frames 24 --lead-in 6 --size 160x120 --seed 4 --quiet
cp other/video.mp4 truth/video.mp4
refused 1 'frame 29 of .*video.mp4 is not the one that kept.partial was made of' track "${whole[@]}"
"$silpose" synth --out other --colour --motion sway --frames 3 --lead-in 6 --size 160x120 --seed 3 --quiet
cp other/video.mp4 truth/video.mp4
refused 1 'video.mp4 ends at frame 9, kept.partial has 30' track "${whole[@]}"
cp video.mp4 truth/video.mp4

cp kept.partial/checkpoint.bin whole.bin
damaged() {
  find kept.partial -type f -exec sha256sum {} + | sort >before.txt
  refused 1 "$1" track "${whole[@]}"
}
truncate -s -100 kept.partial/checkpoint.bin
damaged 'checkpoint.bin: truncated; without --resume'
cp whole.bin kept.partial/checkpoint.bin
printf '\x07' | dd of=kept.partial/checkpoint.bin bs=1 seek=8 conv=notrunc status=none
damaged 'checkpoint of silpose track of version 7, not 6'
cp whole.bin kept.partial/checkpoint.bin
printf 'x' | dd of=kept.partial/checkpoint.bin bs=1 seek=500 conv=notrunc status=none
damaged 'damaged'
cp whole.bin kept.partial/checkpoint.bin
mv kept.partial/masks/000007.png .
damaged 'kept.partial/masks/000007.png: no such file'
mv 000007.png kept.partial/masks
"$silpose" track "${whole[@]}" --resume --out kept --quiet || fail "--resume after all that: exit $?"
same smooth kept "${tables[@]}"
finish
