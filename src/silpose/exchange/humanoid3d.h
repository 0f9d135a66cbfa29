// Humanoid3d: the motion files of DeepMimic's humanoid ("humanoid3d_walk.txt"), as physics simulators pass them on.
// Based on: the JSON form published with peng2018 (references.bib); the file holds no skeleton: joints and offsets are
// those of the humanoid it was recorded for, in metres, y up, facing +x.
// Threads: functions without state.
#pragma once

#include <filesystem>

#include "silpose/base/result.h"
#include "silpose/mocap/clip.h"

namespace silpose {

// A frame is 44 numbers: seconds until the next frame, the root's position, then rotations as quaternions w, x, y, z
// (root, chest, neck; hips, ankles, shoulders) or as one angle in radians (knees, elbows), right limbs before left
// ones. The Clip has these joints, fixed wrists, and end points "head", "right_toe" and "left_toe" that only give the
// direction of their parents. Frames of unequal duration are resampled to the shortest one; whether the motion loops is
// not kept. Errors: missing file, not JSON, no frames, a frame of another length, a value that is not a finite number,
// a quaternion far from unit length, a duration that is not positive, far too many frames once resampled; names file
// and frame.
Result<Clip> read_humanoid3d(const std::filesystem::path& path);

}  // namespace silpose
