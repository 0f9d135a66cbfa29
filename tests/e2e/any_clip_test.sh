# Clips that are not even images at an even rate: turned, of variable rate, of other pixels; masks given as film.
source "$(dirname "$0")/checks.sh"
clip_tool=$3

"$silpose" synth --out truth --colour --lead-in 15 --motion sway --amplitude-deg 20 --frames 20 --size 320x240 --seed 3 --quiet
track=(track --camera truth/camera.toml --init truth/poses.csv --hypotheses 2 --vertices 800 --start 0.5 --quiet --json)
"$silpose" "${track[@]}" truth/video.mp4 --masks truth/masks --out even >even.json || fail "the clip as it is: exit $?"
"$silpose" evaluate --result even --truth truth --json --quiet >errors.json
of_even=$(number errors.json joint_error_root_mm mean)
expect_at_most "$of_even" 60 "the clip as it is: error, mm"

# What is stored otherwise but shown the same is segmented and tracked the same.
segment=(segment --segmenter background --background lead-in:0.5 --quiet --json)
"$silpose" "${segment[@]}" truth/video.mp4 --out masks_even >masks_even.json
area=$(number masks_even.json mean_area_px)
for kind in turned squeezed deep interlaced; do
  "$clip_tool" $kind truth/video.mp4 $kind.mp4
  "$silpose" "${segment[@]}" $kind.mp4 --out masks_$kind >$kind.json || fail "$kind: exit $?"
  expect_at_least "$(number $kind.json mean_area_px)" "$(awk "BEGIN { print 0.96 * $area }")" "$kind: area, px"
  expect_at_most "$(number $kind.json mean_area_px)" "$(awk "BEGIN { print 1.04 * $area }")" "$kind: area, px"
done
grep -q 'made square' squeezed.json || fail "nothing says that pixels were made square"
grep -q 'one field' interlaced.json || fail "nothing says that one field is used"
for kind in turned deep; do
  grep -q '"warnings": \[\]' $kind.json || fail "$kind: there are warnings"
done
"$silpose" "${track[@]}" turned.mp4 --masks truth/masks --out turned >turned.json || fail "turned: exit $?"
cmp -s even/poses.csv turned/poses.csv || fail "a turned clip has other poses"
"$clip_tool" times turned/overlay.mp4 >times.txt
[[ $(head -1 times.txt) == '320 240 20' ]] || fail "turned: the overlay is $(head -1 times.txt)"
"$silpose" segment turned.mp4 --segmenter background --background truth/video.mp4 --out masks_turned --quiet ||
  fail "a plate of the same size as shown is refused"
"$silpose" track truth/video.mp4 --camera truth/camera.toml --background turned.mp4 --particles 10 --layers 1 --end 0.6 \
  --out plate --quiet || fail "a turned plate is refused"

# Something larger next to the subject takes the mask, unless the tracker has predicted where the subject is.
"$clip_tool" boxed truth/video.mp4 boxed.mp4
"$silpose" "${segment[@]}" boxed.mp4 --out masks_boxed >boxed.json
expect_at_least "$(number boxed.json mean_area_px)" "$(awk "BEGIN { print 1.2 * $area }")" "boxed: area without a tracker, px"
"$silpose" "${track[@]}" boxed.mp4 --background lead-in:0.5 --out boxed >boxed.json || fail "boxed: exit $?"
"$silpose" evaluate --result boxed --truth truth --json --quiet >errors.json
expect_at_least "$(number errors.json mask_iou mean)" 0.9 "boxed: masks that the tracker was shown, IoU"

# A subject who is never whole in the image is reported.
"$silpose" synth --out small --motion static --frames 3 --size 160x120 --quiet
"$silpose" segment small/masks --segmenter masks --grow 64 --out masks_cut --json --quiet >cut.json 2>/dev/null ||
  fail "a subject at the edge: exit $?"
grep -q 'reaches the edge of the image in 100 %' cut.json || fail "nothing says that the subject is cut off"
grep -q 'reaches the edge' masks_even.json && fail "the clip as it is: said to be cut off"

# Every fifth frame dropped, time stamps from 1 s on: times are the clip's own from its first frame, also of the overlay,
# and the poses are those of these times.
"$clip_tool" uneven truth/video.mp4 uneven.mkv
mkdir masks_uneven && kept=0
for ((i = 0; i < 35; ++i)); do
  ((i % 5 == 3)) && continue
  cp "truth/masks/$(printf %06d $i).png" "masks_uneven/$(printf %06d $kept).png"
  kept=$((kept + 1))
done
"$silpose" "${track[@]}" uneven.mkv --masks masks_uneven --out uneven >uneven.json || fail "uneven: exit $?"
"$clip_tool" times uneven.mkv >times.txt
python3 - <<'PYTHON' || fail "uneven: see above"
import csv
import subprocess
import sys

kept = [i for i in range(35) if i % 5 != 3]
rows = list(csv.DictReader(open('uneven/poses.csv')))
truth = {int(row['frame']): row for row in csv.DictReader(open('truth/poses.csv'))}
wrong = []
if [int(row['frame']) for row in rows] != [n for n, i in enumerate(kept) if i >= 15]:
    wrong.append('frames %s' % [row['frame'] for row in rows])
for row in rows:
    if abs(float(row['time_s']) - kept[int(row['frame'])] / 30) > 0.0011:
        wrong.append('frame %s is at %s s, not %.3f' % (row['frame'], row['time_s'], kept[int(row['frame'])] / 30))
# The truth of the frames that are left, numbered as they are now.
with open('truth/poses.csv') as file:
    header = file.readline()
import os
os.makedirs('truth_uneven')
def renumbered(name):
    with open('truth/' + name) as file, open('truth_uneven/' + name, 'w') as out:
        out.write(file.readline())
        for line in file:
            frame, rest = line.split(',', 1)
            if int(frame) in kept:
                out.write('%d,%s' % (kept.index(int(frame)), rest))
renumbered('poses.csv')
renumbered('joints.csv')
# Files of an even rate span the same time.
lines = open('uneven/motion.bvh').read().splitlines()
frames = int(next(line for line in lines if line.startswith('Frames:')).split()[1])
interval = float(next(line for line in lines if line.startswith('Frame Time:')).split()[2])
span = float(rows[-1]['time_s']) - float(rows[0]['time_s'])
if abs((frames - 1) * interval - span) > interval:
    wrong.append('motion.bvh spans %.3f s, the clip %.3f' % ((frames - 1) * interval, span))
print('\n'.join(wrong), file=sys.stderr)
sys.exit(1 if wrong else 0)
PYTHON
cp truth/camera.toml truth/run.json truth_uneven/
"$silpose" evaluate --result uneven --truth truth_uneven --json --quiet >errors.json
expect_at_most "$(number errors.json joint_error_root_mm mean)" "$(awk "BEGIN { print 1.3 * $of_even + 5 }")" "uneven: error, mm"
"$clip_tool" times uneven/overlay.mp4 | tail -n +2 | awk '{ print $2 }' >overlay.txt
awk -F, 'NR == 2 { first = $2 } NR > 1 { printf "%.6f\n", $2 - first }' uneven/poses.csv >expected.txt
paste overlay.txt expected.txt | awk '{ if (NF < 2 || ($1 - $2) ^ 2 > 1e-6) exit 1 }' || fail "the overlay is out of step"
"$silpose" "${track[@]/0.5/0.8}" uneven.mkv --masks masks_uneven --end 1.0 --out part >part.json || fail "uneven, a part: exit $?"
awk -F, 'NR > 1 && ($2 < 0.79 || $2 > 1.01) { exit 1 }' part/poses.csv || fail "--start and --end go by other times"
[[ $(number part.json frames) == 6 ]] || fail "0.8 s to 1.0 s holds $(number part.json frames) frames, not 6"
finish
