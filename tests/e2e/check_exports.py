"""check_exports.py RESULT READ_GLB FRAME...: the files for other programs in a result directory, read by their own
rules and compared with poses.csv and joints.csv. FRAME...: those in which nothing was seen."""
import csv
import math
import pathlib
import subprocess
import sys

result = pathlib.Path(sys.argv[1])
unseen = {int(frame) for frame in sys.argv[3:]}
failures = []


def expect(holds, what):
    if not holds:
        failures.append(what)


def near(a, b, tolerance, what):
    expect(len(a) == len(b) and all(abs(x - y) <= tolerance for x, y in zip(a, b)), f"{what}: {a} is not {b}")


# Rotations as lists of rows: an axis and an angle (Rodrigues' formula), products, and what they do to a vector.
def turn(axis, degrees):
    (x, y, z), c, s = axis, math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def chain(*rotations):
    product = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    for r in rotations:
        product = [[sum(product[i][k] * r[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return product


def apply(rotation, vector):
    return [sum(row[k] * vector[k] for k in range(3)) for row in rotation]


X, Y, Z, MINUS_X, MINUS_Y, MINUS_Z = (1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)


with open(result / "poses.csv") as file:
    poses = [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
joints = {}
with open(result / "joints.csv") as file:
    for row in csv.DictReader(file):
        joints.setdefault(int(row["frame"]), {})[row["joint"]] = [float(row[c]) for c in ("x_m", "y_m", "z_m")]
for name in ("markers.trc", "motion.mot", "motion.bvh"):
    expect("nan" not in (result / name).read_text().lower().replace("\t", " ").split(), f"{name} holds NaN")

# markers.trc, as OpenSim reads it: five header lines and a blank one; a tab ends every cell, none too many or few.
lines = (result / "markers.trc").read_text().split("\n")
expect(lines[0] == "PathFileType\t4\t(X/Y/Z)\tmarkers.trc", "first line of markers.trc")
head = dict(zip(lines[1].split("\t"), lines[2].split("\t"), strict=True))
names = [name for name in lines[3].split("\t")[2:] if name]
expect(all(line.endswith("\t") for line in lines[3:5] + lines[6:-1]), "a line of markers.trc without its last tab")
rows = [line[:-1].split("\t") for line in lines[6:-1]]
expect(head["Units"] == "m", "unit of markers.trc")
expect(int(head["NumFrames"]) == len(rows) and int(head["NumMarkers"]) == len(names), "counts in markers.trc")
expect(lines[3].startswith("Frame#\tTime\t") and lines[5] == "" and lines[-1] == "", "trc lines")
expect(lines[4].split("\t")[2:-1] == [f"{c}{i + 1}" for i in range(len(names)) for c in "XYZ"], "trc axis line")
expect(float(head["DataRate"]) == float(head["CameraRate"]) > 0, "rates in markers.trc")
expect(int(head["OrigDataStartFrame"]) == int(rows[0][0]), "first frame of markers.trc")
for row in rows:
    expect(len(row) == 2 + 3 * len(names), f"frame {row[0]} of markers.trc has {len(row)} cells")
    frame = int(row[0])
    near([float(row[1])], [frame / float(head["DataRate"])], 1e-3, "trc time")
    if frame in unseen or frame not in joints:
        expect(not any(row[2:]), f"frame {frame} of markers.trc is not blank")
        continue
    for i, name in enumerate(names):
        if name in joints[frame]:
            place = [float(cell) for cell in row[2 + 3 * i:5 + 3 * i]]
            near(place, joints[frame][name], 1e-6, f"{name} in frame {frame}")
expect(unseen <= {int(row[0]) for row in rows}, "frames missing in markers.trc")
expect(set(joints[min(joints)]) <= set(names), "joints missing in markers.trc")

# motion.mot: the model's bodies stand as the skeleton's, joint after joint about the model's own axes.
header, _, table = (result / "motion.mot").read_text().partition("endheader\n")
head = dict(line.split("=") for line in header.splitlines() if "=" in line)
rows = list(csv.DictReader(table.splitlines(), delimiter="\t"))
rows = [{key: float(value) for key, value in row.items()} for row in rows]
expect(head["inDegrees"] == "yes" and int(head["nRows"]) == len(rows) == len(poses), "mot header")
expect(int(head["nColumns"]) == len(rows[0]) and list(rows[0])[0] == "time", "mot columns")
for pose, row, before in zip(poses, rows, rows[:1] + rows):
    frame = int(pose["frame"])
    near([row["time"]], [pose["time_s"]], 1e-6, "mot time")
    for name in row:
        expect(name == "time" or abs(row[name] - before[name]) < 120, f"{name} jumps in frame {frame}")
    root = chain(turn(Y, pose["root_ry_deg"]), turn(X, pose["root_rx_deg"]), turn(Z, pose["root_rz_deg"]))
    pelvis = chain(turn(Z, row["pelvis_tilt"]), turn(X, row["pelvis_list"]), turn(Y, row["pelvis_rotation"]))
    thorax = chain(root, turn(X, pose["abdomen_rx_deg"] + pose["thorax_rx_deg"]), turn(Z, pose["thorax_rz_deg"]),
                   turn(Y, pose["thorax_ry_deg"]))
    torso = chain(pelvis, turn(Z, row["lumbar_extension"]), turn(X, row["lumbar_bending"]),
                  turn(Y, row["lumbar_rotation"]))

    def same(body, joint, what):  # forward and up are X and Y of the model, Z and Y of ours
        near(apply(body, X), apply(joint, Z), 1e-5, f"forward of {what} in frame {frame}")
        near(apply(body, Y), apply(joint, Y), 1e-5, f"up of {what} in frame {frame}")

    same(pelvis, root, "pelvis")
    same(torso, thorax, "torso")
    hips = [(a + b) / 2 for a, b in zip(joints[frame]["right_thigh"], joints[frame]["left_thigh"])]
    origin = [row["pelvis_tx"], row["pelvis_ty"], row["pelvis_tz"]]
    middle = [a + b for a, b in zip(origin, apply(pelvis, (-0.056276, -0.07849, 0)))]
    near(middle, hips, 2e-6, f"hips in frame {frame}")
    for side, end, add, inward in (("right", "r", X, Y), ("left", "l", MINUS_X, MINUS_Y)):
        ours = lambda name: pose[f"{side}_{name}_deg"]
        model = lambda name: row[f"{name}_{end}"]
        # Our axes: X to the left, Y up, Z forward; of the left limbs Y and Z turn the other way.
        mirrored = side == "left"
        y, z = (MINUS_Y, MINUS_Z) if mirrored else (Y, Z)
        thigh = chain(root, turn(MINUS_X, ours("thigh_rx")), turn(z, -ours("thigh_rz")), turn(y, ours("thigh_ry")))
        femur = chain(pelvis, turn(Z, model("hip_flexion")), turn(add, model("hip_adduction")),
                      turn(inward, model("hip_rotation")))
        same(femur, thigh, f"{side} thigh")
        shin = chain(thigh, turn(X, ours("shin_rx")))
        tibia = chain(femur, turn(MINUS_Z, model("knee_angle")))
        same(tibia, shin, f"{side} shin")
        same(chain(tibia, turn(Z, model("ankle_angle"))), chain(shin, turn(MINUS_X, ours("foot_rx"))), f"{side} foot")
        expect(model("subtalar_angle") == model("mtp_angle") == 0, "what the skeleton lacks is not 0")
        expect(row[f"knee_angle_{end}_beta"] == model("knee_angle"), "the kneecap does not follow")
        upper_arm = chain(thorax, turn(z, -ours("upper_arm_rz")), turn(MINUS_X, ours("upper_arm_rx")),
                          turn(y, ours("upper_arm_ry")))
        humerus = chain(torso, turn(Z, model("arm_flex")), turn(add, model("arm_add")), turn(inward, model("arm_rot")))
        same(humerus, upper_arm, f"{side} upper arm")
        forearm = chain(upper_arm, turn(MINUS_X, ours("forearm_rx")), turn(y, ours("forearm_ry")))
        radius = chain(humerus, turn(Z, model("elbow_flex")), turn(inward, model("pro_sup")))
        hand = chain(forearm, turn(z, ours("hand_rx")), turn(MINUS_X, ours("hand_rz")))
        model_hand = chain(radius, turn(Z, model("wrist_flex")), turn(add, model("wrist_dev")))
        palm = MINUS_X if mirrored else X  # towards the thigh in our zero pose; the model's palm is forward in its own
        near(apply(radius, Y), apply(forearm, Y), 1e-5, f"{side} forearm in frame {frame}")
        near(apply(radius, X), apply(forearm, palm), 1e-5, f"{side} palm before the wrist in frame {frame}")
        near(apply(model_hand, Y), apply(hand, Y), 1e-5, f"{side} hand in frame {frame}")
        near(apply(model_hand, X), apply(hand, palm), 1e-5, f"{side} palm in frame {frame}")

# motion.glb: Assimp finds the joints where joints.csv has them, at the same times.
nodes = {}
read = subprocess.run([sys.argv[2], result / "motion.glb"], check=True, capture_output=True, text=True)
for line in read.stdout.splitlines():
    time_s, name, *place = line.split("\t")
    nodes.setdefault(time_s, {})[name] = [float(value) for value in place]
expect(len(nodes) == len(poses), f"{len(nodes)} keys in motion.glb for {len(poses)} poses")
for (time_s, found), pose in zip(nodes.items(), poses):
    near([float(time_s)], [pose["time_s"]], 1e-5, "glb time")
    for name, place in joints[int(pose["frame"])].items():
        if name != "head_top":
            near(found[name], place, 2e-5, f"{name} of motion.glb in frame {int(pose['frame'])}")

# motion.bvh: no angle jumps from row to row.
lines = (result / "motion.bvh").read_text().partition("Frame Time:")[2].splitlines()[1:]
rows = [[float(value) for value in line.split()] for line in lines]
for before, row in zip(rows, rows[1:]):
    expect(all(abs(a - b) < 120 for a, b in zip(row, before)), "motion.bvh jumps")

for failure in failures[:20]:
    print(failure, file=sys.stderr)
sys.exit(1 if failures else 0)
