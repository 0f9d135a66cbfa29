# The files for other programs: markers.trc, motion.mot, motion.glb, motion.bvh, of a clip in which nobody is seen for a
# while.
here=$(realpath "$(dirname "$0")")
source "$here/checks.sh"
read_glb=$3

"$silpose" synth --out truth --motion sway --amplitude-deg 25 --frames 16 --size 320x240 --view 60 --seed 3 --quiet
cp -r truth/masks masks
python3 - masks/000008.png masks/000009.png <<'PYTHON'  # black images of 320 x 240
import struct, sys, zlib

def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

image = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 320, 240, 8, 0, 0, 0, 0))
image += chunk(b"IDAT", zlib.compress(bytes(240 * 321))) + chunk(b"IEND", b"")
for path in sys.argv[1:]:
    open(path, "wb").write(image)
PYTHON
track=(track masks --segmenter masks --camera truth/camera.toml --init truth/poses.csv --particles 100 --layers 3
       --quiet --json)
"$silpose" "${track[@]}" --threads 1 --out one >one.json
[[ $(number one.json frames_coasted) == 2 ]] || fail "$(number one.json frames_coasted) frames coasted, not 2"
for file in markers.trc motion.mot motion.glb motion.bvh; do
  [[ -s one/$file ]] || fail "track did not write $file"
done
python3 "$here/check_exports.py" one "$read_glb" 8 9 || fail "the files for other programs"
"$silpose" "${track[@]}" --threads 2 --out two >two.json
for file in markers.trc motion.mot motion.glb motion.bvh; do
  cmp -s "one/$file" "two/$file" || fail "$file differs between one thread and two"
done
cp -r one again
"$silpose" "${track[@]}" --end 0.2 --out again >again.json || fail "a result with these files is not replaced: exit $?"

# Nobody at all: no row, no animation, and still whole files.
mkdir nobody_masks
for i in 0 1 2; do cp masks/000008.png nobody_masks/00000$i.png; done
"$silpose" track nobody_masks --segmenter masks --camera truth/camera.toml --out nobody --quiet --json >nobody.json
grep -q -x 'nRows=0' nobody/motion.mot || fail "rows in motion.mot where nobody is seen"
[[ $(wc -l <nobody/markers.trc) == 9 ]] || fail "not three rows in markers.trc where nobody is seen"
[[ -s nobody/motion.glb ]] || fail "no motion.glb where nobody is seen"

# A body of another skeleton (here: one joint is called otherwise) has no motion.mot, and that is said.
"$silpose" model lod --vertices 1000 --out human.body --quiet
python3 - human.body other.body <<'PYTHON'
import struct, sys, zlib

data = open(sys.argv[1], "rb").read()
payload = data[24:].replace(b"\x06\0\0\0thorax", b"\x06\0\0\0midway")
open(sys.argv[2], "wb").write(data[:12] + struct.pack("<I", zlib.crc32(payload)) + data[16:24] + payload)
PYTHON
"$silpose" "${track[@]}" --model other.body --end 0.2 --out other >other.json || fail "another skeleton: exit $?"
[[ ! -e other/motion.mot && -s other/motion.glb && -s other/markers.trc ]] || fail "another skeleton: $(ls other)"
grep -q 'no motion.mot: ' other.json || fail "no warning that there is no motion.mot"
finish
