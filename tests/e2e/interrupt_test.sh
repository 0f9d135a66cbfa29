# Ctrl-C: exit 130, the frames done are in DIR.partial, valid, and an earlier result is untouched.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --motion sway --frames 60 --size 320x240 --quiet
mkdir earlier && cp -r truth/. earlier
status=0
"$silpose" track truth/masks --segmenter masks --camera truth/camera.toml --init truth/poses.csv --particles 300 --layers 5 \
  --out earlier --quiet --json >out.json 2>err.txt &
process=$!
for ((wait = 0; wait < 300; ++wait)); do  # until some frames are done
  [[ -e earlier.partial/masks/000004.png ]] && break
  sleep 0.1
done
kill -INT $process
wait $process || status=$?
[[ $status == 130 ]] || fail "exit $status, not 130: $(cat err.txt)"
cmp -s truth/poses.csv earlier/poses.csv || fail "the earlier result was touched"
rows=$(($(wc -l <earlier.partial/poses.csv) - 1))
[[ $rows -ge 4 && $rows -lt 60 ]] || fail "$rows rows in the partial poses.csv"
"$silpose" evaluate --result earlier.partial --truth truth --json --quiet >errors.json || fail "the partial result is not valid"
for file in markers.trc motion.mot motion.glb motion.bvh; do
  [[ -s earlier.partial/$file ]] || fail "no $file in the partial result"
done
[[ $(number errors.json frames) -ge 4 ]] || fail "evaluate finds no frames in the partial result"

# The same command again starts from scratch and replaces both.
"$silpose" track truth/masks --segmenter masks --camera truth/camera.toml --init truth/poses.csv --particles 20 --layers 1 \
  --end 0.2 --out earlier --quiet
[[ ! -e earlier.partial ]] || fail "earlier.partial is left behind"
finish
