// MOT: poses of the human as coordinates of Rajagopal2016, OpenSim's full-body model.
// The model's body frames are X forward, Y up, Z to the right in its zero pose; its ground is our world as it is.
// Angles are those of the rotation matrices between bodies, decomposed in the model's own order about its own axes.
// Source: the model (references.bib: rajagopal2016) in OpenSim's distribution; docs/formats.md has the table. Threads:
// functions without state.
#pragma once

#include <filesystem>

#include "silpose/base/result.h"
#include "silpose/body/skeleton.h"
#include "silpose/exchange/tables.h"

namespace silpose {

// True where the skeleton has the human's joints, whatever their degrees of freedom; their zero pose is taken to be the
// human's.
[[nodiscard]] bool has_opensim_coordinates(const Skeleton& skeleton);

// One row per row of `poses`, in degrees and metres, curves without jumps.
// Errors: not writable. Throws std::invalid_argument unless has_opensim_coordinates() and poses have the skeleton's
// size.
Result<void> write_mot(const std::filesystem::path& path, const Skeleton& skeleton, const PoseTable& poses);

}  // namespace silpose
