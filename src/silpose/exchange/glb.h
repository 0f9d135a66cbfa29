// GLB: a body as one binary glTF 2.0 file: mesh, skeleton, skin, and its poses as an animation.
// glTF's world is ours: Y up, right-handed, a figure faces +Z, metres and seconds.
// Source: glTF 2.0 (references.bib: gltf2021).
// Threads: functions without state.
#pragma once

#include <filesystem>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/exchange/tables.h"

namespace silpose {

// One node per joint, in standing_pose(); the four largest skin weights of each vertex, brought to a sum of 1; keys at
// the rows' times, linear between them: rotations of every joint that turns, translations of those that move.
// A row that is not later than the one before, in single precision, has no key. Without rows there is no animation.
// Errors: not writable. Throws std::invalid_argument when poses have another size or the body has no mesh.
Result<void> write_glb(const std::filesystem::path& path, const BodyModel& body, const PoseTable& poses);

}  // namespace silpose
