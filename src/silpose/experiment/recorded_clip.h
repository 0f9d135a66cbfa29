// The cameras and the truth of a recorded clip, as a grid file names them.
// Threads: values and functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/evaluate/evaluation.h"
#include "silpose/experiment/run_settings.h"
#include "silpose/geometry/camera.h"

namespace silpose {

// Points on the subject's surface in one frame, world coordinates, metres.
struct TrueSurface {
  int64_t frame = 0;
  std::vector<Eigen::Vector3f> points;
};

// One of both.
struct ClipTruth {
  std::optional<Recorded> joints;     // joints.csv, and what else `silpose evaluate --truth` takes
  std::vector<TrueSurface> surfaces;  // ascending frames
};

// [C], one per video of the settings. A .toml calibration as everywhere, or a .json object {width, height, K, dist (up
// to 5), R_world_to_cam, t_world_to_cam_m}: one camera, metres, world Y up, pixels with the centre of the top-left one
// at
// 0.5. Errors: unreadable; not such a file; no camera of a name; another number of cameras than videos.
Result<std::vector<PinholeCamera>> read_clip_cameras(const RunSettings& settings, const std::filesystem::path& data);

// Of a folder with joints.csv, or else with files *NUMBER.ply: number n is frame n - 1 (as Depthkit counts), and of
// their vertices those above `truth_above`. Errors: those of read_recorded() and read_ply_vertices(); neither is there;
// no vertex is left of a mesh.
Result<ClipTruth> read_clip_truth(const RunSettings& settings, const std::filesystem::path& data,
                                  const BodyModel& body);

// Whether everything that a run on a clip reads from `data` is there. Errors: names what is not.
Result<void> check_clip_files(const RunSettings& settings, const std::filesystem::path& data);

}  // namespace silpose
