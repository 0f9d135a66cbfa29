# Two cameras film a board; the result of calibrate is compared with the cameras that filmed.
source "$(dirname "$0")/checks.sh"

"$3" .
calibrate=(calibrate left.mp4 right.mp4 --board 8x5 --square 60 --floor-frame 1.3)
"$silpose" "${calibrate[@]}" --out rig.toml --quiet --json >rig.json
python3 - <<'PYTHON' || fail "the cameras are not where they are"
import json
import math
import sys
import tomllib

truth, found = (tomllib.load(open(name, "rb")) for name in ("truth.toml", "rig.toml"))
report = {camera["name"]: camera for camera in json.load(open("rig.json"))["cameras"]}


def rotation(camera):
    x, y, z = camera["rotation"]
    angle = math.sqrt(x * x + y * y + z * z)
    x, y, z, s, c = x / angle, y / angle, z / angle, math.sin(angle), math.cos(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def centre(camera):
    r, t = rotation(camera), camera["translation"]
    return [-sum(r[i][j] * t[i] for i in range(3)) for j in range(3)]


def distance(a, b):
    return math.dist(a, b)


assert list(found) == ["left", "right", "metadata"], list(found)
for name in ("left", "right"):
    assert found[name]["size"] == [480, 360]
    for axis in (0, 1):
        ratio = found[name]["matrix"][axis][axis] / truth[name]["matrix"][axis][axis]
        assert abs(ratio - 1) < 0.005, f"{name}: focal length off by {ratio}"
    # The board's middle, the origin, lies at (0, 0, 0.2).
    x, y, z = centre(truth[name])
    off = distance(centre(found[name]), (x, y, z - 0.2))
    assert off < 0.015, f"{name}: stands {off} m from its place"
    assert report[name]["views"] >= 15 and report[name]["rms_px"] < 0.5, report[name]
base = [distance(centre(of["left"]), centre(of["right"])) for of in (truth, found)]
assert abs(base[0] - base[1]) < 0.005, base
print(report, base)
PYTHON

# The file is one that track reads.
"$silpose" track left.mp4 --camera rig.toml --camera-name left --segmenter background --region 0,0,8,8 --end 0.1 --out seen \
  --quiet --json >seen.json || fail "track does not read the calibration"

# One camera, without a floor: said so. The same for any number of threads.
for threads in 1 2; do
  "$silpose" calibrate left.mp4 --board 8x5 --square 60 --out one$threads.toml --camera-name webcam --threads $threads --quiet --json \
    >one.json 2>err.txt
done
cmp -s one1.toml one2.toml || fail "another number of threads makes another calibration"
grep -q 'webcam.*level' err.txt || fail "no warning that the floor is a guess"
grep -q '"floor": "assumed"' one.json || fail "not said that the floor is assumed"

# Errors are named, and an earlier file is left unchanged.
cp rig.toml before.toml
expect_failure 2 'square' calibrate left.mp4 --out rig.toml
expect_failure 2 'board.*eight' calibrate left.mp4 --out rig.toml --square 60 --board eight
expect_failure 2 'board.*2x6' calibrate left.mp4 --out rig.toml --square 60 --board 2x6
expect_failure 2 'upside down' calibrate left.mp4 right.mp4 --out rig.toml --square 60 --board 8x6
expect_failure 2 'named left' calibrate left.mp4 left.mp4 --out rig.toml --square 60 --board 8x5
expect_failure 2 'camera-name' calibrate left.mp4 right.mp4 --out rig.toml --square 60 --camera-name one
expect_failure 1 'absent.mp4' calibrate absent.mp4 --out rig.toml --square 60
expect_failure 1 'left.mp4: no chessboard of 11x6' calibrate left.mp4 --out rig.toml --square 60 --board 11x6
expect_failure 1 'ends before 9 s, where the board' calibrate left.mp4 --out rig.toml --square 60 --board 8x5 --floor-frame 9
expect_failure 1 'seen: is a directory' calibrate left.mp4 --out seen --square 60 --board 8x5
cmp -s before.toml rig.toml || fail "a failure changed the earlier calibration"

# Ctrl-C: exit 130 and nothing written.
status=0
"$silpose" "${calibrate[@]}" --out stopped.toml --quiet --json >out.json 2>err.txt &
process=$!
for ((wait = 0; wait < 300; ++wait)); do  # until it listens to signals: bit 2 is SIGINT
  caught=$(sed -n 's/^SigCgt:[[:space:]]*//p' /proc/$process/status)
  [[ $((16#${caught:-0} & 2)) != 0 ]] && break
  sleep 0.02
done
kill -INT $process
wait $process || status=$?
[[ $status == 130 && ! -e stopped.toml && ! -e stopped.partial.toml ]] || fail "exit $status, not 130: $(cat err.txt)"
finish
