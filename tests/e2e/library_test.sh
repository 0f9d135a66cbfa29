# What the library gives a program is what the command gives; a clip is opened once per pass.
source "$(dirname "$0")/checks.sh"
example=$3 count_opens=$4

"$silpose" synth --out truth --colour --motion sway --frames 24 --lead-in 6 --size 320x240 --seed 3 --quiet
"$silpose" synth --out still --motion sway --frames 24 --size 320x240 --seed 3 --quiet
"$silpose" model build --out human.body --quiet

# Frames in memory, given to the library by a program of 50 lines.
"$silpose" track still/masks --camera still/camera.toml --model human.body --out command --quiet
"$example" still/masks still/camera.toml human.body >library.txt
python3 - command/poses.csv >command.txt <<'PYTHON'
import csv
import sys

for row in csv.DictReader(line for line in open(sys.argv[1]) if not line.startswith("#")):
    print(row["frame"], f"{float(row['time_s']):.4f}", f"{float(row['visual_accuracy']):.4f}")
PYTHON
[[ $(wc -l <library.txt) -ge 24 ]] || fail "the example prints $(wc -l <library.txt) lines"
cmp -s command.txt library.txt || fail "the example tracks otherwise: $(diff command.txt library.txt | head -4)"

# opens NUMBER WHAT ARGUMENT...: how often `silpose track` opens the clip.
opens() {
  local expected=$1 what=$2
  shift 2
  rm -f opens.txt
  COUNT_OPENS_OF=$PWD/truth/video.mp4 COUNT_OPENS_LOG=opens.txt LD_PRELOAD=$count_opens \
    "$silpose" track truth/video.mp4 "$@" --out counted --quiet
  touch opens.txt
  [[ $(wc -l <opens.txt) == "$expected" ]] || fail "$what: opened $(wc -l <opens.txt) times, not $expected"
}
small=(--camera truth/camera.toml --vertices 600 --hypotheses 2)
opens 2 "background learned in one pass, tracked in another" --segmenter background "${small[@]}"
opens 1 "background learned on the way" --segmenter background --background online "${small[@]}"
opens 3 "smoothed: the overlay is a pass of its own" --segmenter background "${small[@]}" --smooth
finish
