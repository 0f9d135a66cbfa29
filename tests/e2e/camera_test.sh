# Without a calibration file the camera is estimated from the person who walks in front of it, with a message; or
# assumed.
source "$(dirname "$0")/checks.sh"

"$silpose" synth --out truth --motion circle --frames 16 --fps 4 --quiet
track=(track truth/masks --segmenter masks --fps 4 --init truth/poses.csv --hypotheses 1 --vertices 600 --quiet --json)
"$silpose" "${track[@]}" --out estimated >estimated.json 2>warnings.txt || fail "an estimated camera: exit $?"
grep -q 'no camera file: estimated from the subject in 1[0-9] frames: focal length' warnings.txt || fail "nothing says so"
# A level camera: its translation along y is its height.
truth_m=$(sed -n 's/^translation = \[[^,]*, \([^,]*\),.*/\1/p' truth/camera.toml)
expect_at_least "$(number estimated.json camera_estimate height_m mean)" "$(awk "BEGIN { print $truth_m - 0.15 }")" "height, m"
expect_at_most "$(number estimated.json camera_estimate height_m mean)" "$(awk "BEGIN { print $truth_m + 0.15 }")" "height, m"
expect_at_most "$(number estimated.json camera_estimate tilt_deg mean)" 3 "tilt, degrees"
expect_at_least "$(number estimated.json camera_estimate tilt_deg mean)" -3 "tilt, degrees"
expect_at_least "$(number estimated.json camera_estimate focal_px std)" 50 "deviation of a focal length that nothing determines"
[[ $(number estimated.json focal_prior mean) == 480.0 ]] || fail "another prior than 0.75 of 640 px"
# 90 degrees over 640 px; kept as it is.
"$silpose" "${track[@]}" --fov-deg 90 --out given >given.json 2>warnings.txt || fail "--fov-deg: exit $?"
grep -q 'focal length 320 px (--fov-deg)' warnings.txt || fail "nothing says whose focal length it is: $(cat warnings.txt)"
expect_at_most "$(number given.json camera_estimate focal_px std)" 0 "deviation of a focal length that is given"
grep -q 'none: estimated' estimated/report.html || fail "the report does not say so"

# The result's files lead to the same: its options, and its camera.
"$silpose" track --config estimated/config.toml --out again --quiet || fail "--config: exit $?"
cmp -s estimated/poses.csv again/poses.csv || fail "--config: other poses"
"$silpose" track --config estimated/config.toml --camera estimated/camera.toml --out again --quiet || fail "--camera: exit $?"
[[ $(grep matrix estimated/camera.toml) == "$(grep matrix again/camera.toml)" ]] || fail "--camera: another camera"

"$silpose" "${track[@]}" --camera assumed --end 0.1 --out assumed >assumed.json 2>warnings.txt || fail "an assumed camera: exit $?"
grep -q 'assumed a level camera 1.5 m above the floor, focal length 480 ± 96 px' warnings.txt || fail "nothing says that the camera is assumed"
grep -q 'camera_estimate' assumed.json && fail "an assumed camera is called an estimate"
"$silpose" "${track[@]}" --end 0.1 --out short >short.json 2>warnings.txt || fail "a clip that is too short: exit $?"
grep -q 'the camera was not estimated: too few of 1 frames' warnings.txt ||
  fail "nothing says why the camera was not estimated"
expect_failure 2 'fit-body: .*--camera' track truth/masks --camera assumed --preset accurate --fit-body --out no
expect_failure 1 'assumed: ' synth --camera assumed --out no
finish
