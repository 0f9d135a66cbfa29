// The files of a tracked clip: their names, and those that are made from its recording.
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/recording/track_recording.h"
#include "silpose/session/checkpoint.h"
#include "silpose/session/overlay_file.h"

namespace silpose {

// The body whose bones were fitted to the clip.
inline constexpr std::string_view kFittedBodyFile = "fitted.body";

struct ResultFile {
  std::string_view name;
  std::string_view content;  // for people; empty: of no use outside of silpose
};

// Every file that silpose writes into the directory of a result. Mask folders are kMaskFolder and kConfidenceFolder.
inline constexpr ResultFile kResultFiles[] = {
    {"poses.csv", "angles and root position of every frame"},
    {"joints.csv", "joint positions, pixels and spread"},
    {"spread.csv", "standard deviation of every angle"},
    {"motion.bvh", "the motion, for Blender and others"},
    {"markers.trc", "joints as markers, for OpenSim"},
    {"motion.mot", "coordinates, for OpenSim"},
    {"motion.glb", "the body and its motion as glTF"},
    {kOverlayFile, "the video"},
    {"poses_normalised.csv", ""},
    {"camera.toml", ""},
    {kFittedBodyFile, ""},
    {"video.mp4", ""},
    {"report.html", ""},
    {"config.toml", ""},
    {"run.json", ""},
    {kCheckpointFile, ""},
};

// A tracked clip.
struct TrackedClip {
  const TrackRecording& recording;
  const BodyModel& body;
  const std::vector<PinholeCamera>& cameras;
  double fps = 30;  // of files that need a constant rate
};

// Writes camera.toml and, where the recording has steps, poses, poses_normalised, spread and joints as CSV, motion.bvh,
// motion.glb, markers.trc and, where the skeleton is the human's, motion.mot. Errors: not writable.
Result<void> write_result_files(const std::filesystem::path& folder, const TrackedClip& clip);

}  // namespace silpose
