// A SyntheticSequence as a truth directory (docs/formats.md): masks/, camera.toml, poses.csv, poses_normalised.csv,
// joints.csv and, in colour, video.mp4. With several cameras: masks_NAME/ and video_NAME.mp4 each.
// Threads: draws on all cores; the files do not depend on how many.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/exchange/tables.h"
#include "silpose/synth/colour_scene.h"
#include "silpose/synth/degraded_mask.h"
#include "silpose/synth/scene.h"

namespace silpose {

// Writes into `directory`, which is created where it is missing; the caller gives it its final name afterwards. Frame
// numbers and times count from the video's first image; frames of the lead-in have an empty mask and no rows.
// Returns the number of frames written: fewer than there are when `progress` asked to stop, and the files describe
// those. `masks`, one per camera, are written in place of the true ones; the tables stay true.
// Errors: anything that cannot be written; throws std::invalid_argument for another number of `masks` than cameras.
Result<int> write_sequence(const std::filesystem::path& directory, const SyntheticSequence& sequence,
                           const std::optional<ColourOptions>& colour = std::nullopt, ProgressSink* progress = nullptr,
                           std::span<const DegradedMasks> masks = {});

// The truth of frames [0, num_frames) as plain values. Joints: landmarks (body/body_model.h), pixels of the first
// camera.
PoseTable true_poses(const SyntheticSequence& sequence, int num_frames);
JointTable true_joints(const SyntheticSequence& sequence, int num_frames);

}  // namespace silpose
