# Whatever is wrong with the input: one line that names the thing, exit 1 (2 for wrong usage), earlier results untouched.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --motion static --frames 3 --size 160x120 --quiet >log.txt
"$silpose" synth --out other --motion static --frames 3 --size 200x120 --quiet >log.txt
"$silpose" synth --out colour --colour --motion static --frames 3 --size 160x120 --quiet >log.txt
cp -r truth result  # an earlier result, which every failure must leave alone
find result -type f -exec sha256sum {} + | sort >before.txt
plain=(track --out result --particles 10 --layers 1)
track=("${plain[@]}" --camera truth/camera.toml)
masks=("${track[@]}" truth/masks --segmenter masks)
uncalibrated=("${plain[@]}" truth/masks --segmenter masks)

# Wrong usage.
expect_failure 2 'nonsense' nonsense
expect_failure 2 'subcommand' --seed 1
fitted=(track --out result truth/masks --segmenter masks)
expect_failure 2 'hypotheses.*particles' "${masks[@]}" --hypotheses 3
expect_failure 2 'hypotheses.*thesis' "${fitted[@]}" --preset thesis --hypotheses 3
expect_failure 2 'hypotheses' "${fitted[@]}" --hypotheses 0
expect_failure 2 'smooth.*layers' "${fitted[@]}" --smooth --layers 2
expect_failure 2 'smooth.*thesis' "${fitted[@]}" --smooth --preset thesis
expect_failure 2 'floor.*layers' "${fitted[@]}" --floor --layers 2
expect_failure 2 'smooth.*camera:0 is live' track camera:0 --out result --smooth
expect_failure 2 'fit-body.*layers' "${fitted[@]}" --fit-body --layers 2
expect_failure 2 'fit-body.*learned.*--camera' "${fitted[@]}" --fit-body
expect_failure 2 'fit-body.*landmarks' "${fitted[@]}" --fit-body --evidence landmarks
expect_failure 2 'fit-body.*camera:0 is live' track camera:0 --out result --fit-body
expect_failure 2 'fit-body.*camera' "${fitted[@]}" --fit-body --smooth
fit=(model fit truth/masks --segmenter masks --quiet)
expect_failure 2 'camera.*missing' "${fit[@]}" --out subject.body
expect_failure 2 'VIDEO' model fit --camera truth/camera.toml --out subject.body
expect_failure 2 'subject.txt: does not end in .body' "${fit[@]}" --camera truth/camera.toml --out subject.txt
expect_failure 1 'no folder.*nowhere' "${fit[@]}" --camera truth/camera.toml --out nowhere/subject.body
expect_failure 1 'no_such.toml' "${fit[@]}" --camera no_such.toml --out subject.body
expect_failure 2 'smooth.*camera:0 is live' track camera:0 --out result --preset accurate
expect_failure 2 'vertices' "${fitted[@]}" --vertices 7
for option in '--motion diffusion' '--sigma-deg 3' '--resampling comb' '--resample-below 0.5' '--regenerate 0.1' \
              '--sharpness 50' '--metric pixel-count' '--root fixed' '--estimate mode'; do
  expect_failure 2 "${option%% *}.*particles" "${fitted[@]}" $option
done
expect_failure 2 'focal-mm35.*fov-deg' "${uncalibrated[@]}" --focal-mm35 26 --fov-deg 70
expect_failure 2 'fov-deg.*camera truth/camera.toml' "${masks[@]}" --fov-deg 70
expect_failure 2 'focal-mm35' "${uncalibrated[@]}" --focal-mm35 0
expect_failure 2 'fov-deg' "${uncalibrated[@]}" --fov-deg nan
expect_failure 2 'out' track truth/masks
expect_failure 2 'VIDEO' track --out result
expect_failure 2 'particles' "${masks[@]}" --particles 0
expect_failure 2 'particles' "${masks[@]}" --particles many
expect_failure 2 'layers' "${masks[@]}" --layers -3
expect_failure 2 'sigma-deg' "${masks[@]}" --sigma-deg -1
expect_failure 2 'regenerate' "${masks[@]}" --regenerate 1.5
expect_failure 2 'resample-below' "${masks[@]}" --resample-below 2
expect_failure 2 'motion' "${masks[@]}" --motion hopping
expect_failure 2 'metric' "${masks[@]}" --metric beauty
expect_failure 2 'resampling' "${masks[@]}" --resampling raffle
expect_failure 2 'segmenter' "${track[@]}" truth/masks --segmenter magic
expect_failure 2 'preset' "${masks[@]}" --preset magic
expect_failure 2 'region' "${masks[@]}" --region 1,2,3
expect_failure 2 'key-colour.*chartreuse' "${track[@]}" colour/video.mp4 --segmenter chroma --key-colour chartreuse
expect_failure 2 'key-colour.*#888888.*grey' "${track[@]}" colour/video.mp4 --segmenter chroma --key-colour '#888888'
expect_failure 2 'key-colour.*segmenter chroma' "${track[@]}" colour/video.mp4 --key-colour '#00b140'
expect_failure 2 'start' "${masks[@]}" --start 2 --end 1
for option in start end fps sigma-deg sharpness resample-below regenerate; do
  expect_failure 2 "$option" "${masks[@]}" --$option nan
done
expect_failure 2 'start' "${masks[@]}" --start 1e300
expect_failure 2 'seed' "${masks[@]}" --seed -1
expect_failure 2 'seed' "${masks[@]}" --seed 99999999999999999999
expect_failure 2 'amplitude-deg' synth --out new --motion sway --amplitude-deg nan
expect_failure 2 'front' synth --out new --view front --view front
expect_failure 2 'size' synth --out new --size 0x0
expect_failure 2 'frames' synth --out new --frames 0
expect_failure 2 'view' synth --out new --view above

# Videos.
: >empty.mp4
echo 'not a video' >text.mp4
head -c 300 colour/video.mp4 >stump.mp4
mkdir folder
mkdir sizes && cp truth/masks/000000.png sizes/000000.png && cp other/masks/000001.png sizes/000001.png
expect_failure 1 'absent.mp4' "${track[@]}" absent.mp4
expect_failure 1 'empty.mp4' "${track[@]}" empty.mp4
expect_failure 1 'text.mp4' "${track[@]}" text.mp4
expect_failure 1 'stump.mp4' "${track[@]}" stump.mp4
expect_failure 1 'folder' "${track[@]}" folder
expect_failure 1 'sizes' "${track[@]}" sizes --segmenter masks
expect_failure 1 'start' "${masks[@]}" --start 100

# Calibrations.
grep -v '^matrix' truth/camera.toml >no_matrix.toml
sed -E 's/^translation = .*/translation = [nan, 0.0, 5.5]/' truth/camera.toml >nan.toml
sed -E 's/^name = .*/name = "..\/elsewhere"/' truth/camera.toml >name.toml
echo 'this is [ not TOML' >broken.toml
expect_failure 1 'absent.toml' "${uncalibrated[@]}" --camera absent.toml
expect_failure 1 'no_matrix.toml.*matrix' "${uncalibrated[@]}" --camera no_matrix.toml
expect_failure 1 'nan.toml' "${uncalibrated[@]}" --camera nan.toml
expect_failure 1 'name.toml.*elsewhere' "${uncalibrated[@]}" --camera name.toml
expect_failure 1 'broken.toml' "${uncalibrated[@]}" --camera broken.toml
expect_failure 1 'other/camera.toml.*200x120' "${uncalibrated[@]}" --camera other/camera.toml
expect_failure 1 'nobody' "${masks[@]}" --camera-name nobody

# Backgrounds and masks.
expect_failure 1 'other/masks/000000.png' "${track[@]}" colour/video.mp4 --background other/masks/000000.png
expect_failure 1 'absent.png' "${track[@]}" colour/video.mp4 --background absent.png
expect_failure 1 'other/masks' "${track[@]}" colour/video.mp4 --masks other/masks
mkdir twice && cp truth/masks/000001.png twice && cp truth/masks/000001.png twice/1.png
expect_failure 1 'twice.*same number' "${track[@]}" twice --segmenter masks
mkdir few && cp truth/masks/000000.png truth/masks/000001.png few
expect_failure 1 'few' "${track[@]}" colour/video.mp4 --masks few
expect_failure 1 'other/masks/000000.png' "${masks[@]}" --garbage-mask other/masks/000000.png
expect_failure 1 'lead-in' "${track[@]}" colour/video.mp4 --background lead-in:60

expect_failure 1 'colour/video.mp4.*no screen' "${track[@]}" colour/video.mp4 --segmenter chroma --key-colour '#0000ff'

# Depth.
depth() {  # FOLDER COUNT WIDTH HEIGHT BITS: flat depth images, 16-bit or 8-bit grey
  mkdir "$1"
  python3 - "$@" <<'PYTHON'
import struct
import sys
import zlib

folder, count, width, height, bits = sys.argv[1], *map(int, sys.argv[2:])
chunk = lambda kind, body: struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = (b'\0' + b'\x07\xd0'[: bits // 8] * width) * height
for i in range(count):
    with open(f'{folder}/{i:06}.png', 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, bits, 0, 0, 0, 0)) +
                   chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))
PYTHON
}
depth deep 3 160 120 16
depth shallow 3 160 120 8
depth wide 3 200 120 16
depth short 1 160 120 16
by_depth=("${track[@]}" colour/video.mp4 --segmenter depth)
"$silpose" segment colour/video.mp4 --segmenter depth --depth deep --depth-range 1,3 --out near --quiet >log.txt ||
  fail "depth images are refused"
expect_failure 2 'segmenter depth.*--depth' "${by_depth[@]}"
expect_failure 2 'depth.*segmenter depth' "${track[@]}" colour/video.mp4 --depth deep
expect_failure 1 'short: 1 depth images for 3 frames' "${track[@]}" colour/video.mp4 --segmenter background --depth short
expect_failure 1 'not an online one' "${track[@]}" colour/video.mp4 --segmenter background --background online --depth deep
expect_failure 2 'depth-range.*2,1' "${by_depth[@]}" --depth deep --depth-range 2,1
expect_failure 2 'depth-range' "${by_depth[@]}" --depth deep --depth-range near
expect_failure 2 'depth-range' "${by_depth[@]}" --depth deep --depth-range 1,nan
expect_failure 1 'absent' "${by_depth[@]}" --depth absent
expect_failure 1 'shallow/000000.png.*8 bits' "${by_depth[@]}" --depth shallow
expect_failure 1 'wide/000000.png.*200x120.*160x120' "${by_depth[@]}" --depth wide
expect_failure 1 'short: 1 depth images for 3 frames' "${by_depth[@]}" --depth short

# Poses.
sed '1s/abdomen/tummy/' truth/poses.csv >columns.csv
sed -E '2s/[^,]*$/nan/' truth/poses.csv >nan.csv
: >empty.csv
awk -F, -v OFS=, 'NR == 2 { $3 = "1e300" } 1' truth/poses.csv >huge.csv
expect_failure 1 'columns.csv' "${masks[@]}" --init columns.csv
expect_failure 1 'huge.csv.*1e300' "${masks[@]}" --init huge.csv
expect_failure 1 'huge.csv.*1e300' render --pose huge.csv --out image.png
expect_failure 1 'nan.csv' "${masks[@]}" --init nan.csv
expect_failure 1 'empty.csv' "${masks[@]}" --init empty.csv
expect_failure 1 'init landmarks: masks finds none' "${masks[@]}" --init landmarks
expect_failure 1 'evidence landmarks: masks finds none' "${masks[@]}" --evidence landmarks
expect_failure 1 'regenerate-from network: masks finds no keypoints' "${masks[@]}" --preset thesis --regenerate-from network
expect_failure 1 'absent.csv' render --pose absent.csv --out image.png
expect_failure '1|2' 'poses.csv:99' render --pose truth/poses.csv:99 --out image.png
expect_failure 1 'folder' evaluate --result folder --truth truth
mkdir wrong && cp columns.csv wrong/poses.csv
expect_failure 1 'wrong/poses.csv' evaluate --result wrong --truth truth
expect_failure 1 'absent' evaluate --result result --truth absent
expect_failure 2 'start' evaluate --result result --truth truth --start 1 --end 1
expect_failure 2 'end' evaluate --result result --truth truth --end nan
expect_failure 1 'truth.*--start' evaluate --result result --truth truth --start 100
mkdir joints && sed 's/,right_foot,/,right_wheel,/' truth/joints.csv >joints/joints.csv
expect_failure 1 'joints/joints.csv.*right_wheel' evaluate --result joints --truth truth
mkdir odd && cp truth/poses.csv odd && echo '{"model": 5}' >odd/run.json
mkdir centaur && cp truth/poses.csv centaur && echo '{"model": "centaur"}' >centaur/run.json
expect_failure 1 'centaur' evaluate --result centaur --truth truth
"$silpose" evaluate --result odd --truth truth --quiet >log.txt || fail "a run.json without a model stops evaluate"

# Motions and bodies.
printf 'HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0\n' >broken.bvh
expect_failure 1 'broken.bvh' synth --out new --motion broken.bvh
printf 'HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 1 Xrotation\n}\nMOTION\nFrames: 1\nFrame Time: 1e300\n0\n' >slow.bvh
expect_failure 1 'slow.bvh.*1e300' synth --out new --motion slow.bvh
expect_failure 1 'absent.bvh' synth --out new --motion absent.bvh
expect_failure 2 'dancing' synth --out new --motion dancing
expect_failure 2 'dof:37' synth --out new --motion dof:37
expect_failure 2 'centaur' "${masks[@]}" --model centaur
expect_failure 2 'wings' "${masks[@]}" --model human:wings=2
expect_failure 2 'height' "${masks[@]}" --model human:height=4
expect_failure 1 'absent.body' "${masks[@]}" --model absent.body
expect_failure 1 'text.body' "${masks[@]}" --model text.body
export SILPOSE_DATA=$PWD/no-data
expect_failure 1 'no-data.*fetch-body-data' "${masks[@]}"
expect_failure 1 'no-data.*fetch-network-data' segment colour/video.mp4 --segmenter learned --out result
unset SILPOSE_DATA

# Outputs.
mkdir mine && echo precious >mine/letter.txt
expect_failure 1 'mine' synth --out mine --frames 1
[[ $(cat mine/letter.txt) == precious ]] || fail "a directory of other things was touched"
echo precious >file
expect_failure 1 'file' synth --out file --frames 1
expect_failure 1 'file/new' synth --out file/new --frames 1
expect_failure 1 'file/image.png' render --pose truth/poses.csv --out file/image.png
echo 'wheels = 4' >wheels.toml
expect_failure '1|2' 'wheels' "${masks[@]}" --config wheels.toml

[[ ! -e new && ! -e result.partial && ! -e new.partial ]] || fail "something is left behind: $(ls)"
find result -type f -exec sha256sum {} + | sort >after.txt
cmp -s before.txt after.txt || fail "an earlier result was touched"
finish
