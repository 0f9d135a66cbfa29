// BVH: motion-capture files read into a Clip, and poses of our skeletons written.
// Based on: the Biovision hierarchy format as capture software writes it (references.bib: meredith2001).
// Position channels are the joint's position in its parent, as most software interprets them; where those of a joint
// that is not a root are zero throughout, its OFFSET is used.
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/mocap/clip.h"

namespace silpose {

// Any channel order, several roots, joint names with blanks, tabs; end sites become joints named "<parent>_end".
// Errors: missing or empty file, not BVH, broken hierarchy, unknown channel, a value that is not a finite number, a
// line with too few or too many values, other than the stated number of frames; names file and line.
Result<Clip> read_bvh(const std::filesystem::path& path);

// Every joint turns by three channels (Z, X, Y), in degrees, curves without jumps (unwrapped_euler.h); roots, and
// joints whose translation changes, move by three more. Joints are written depth first, a joint without children gets
// an end site. Errors: not writable.
Result<void> write_bvh(const std::filesystem::path& path, const Clip& clip);

// The motion of a skeleton, metres: poses [T][D]; an end point becomes the end site of its joint where that is a leaf.
// Errors: throws std::invalid_argument when a pose has another size or fps is not positive.
Clip clip_from_poses(const Skeleton& skeleton, std::span<const std::vector<double>> poses, double fps,
                     std::span<const BodyModel::EndPoint> end_points = {});

}  // namespace silpose
