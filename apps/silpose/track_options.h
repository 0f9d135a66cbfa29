// The options of `silpose track`, and the tracker they ask for.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/silpose/camera_choice.h"
#include "apps/silpose/observation_source.h"
#include "silpose/base/result.h"
#include "silpose/track/tracker.h"

namespace silpose::app {

struct TrackOptions {
  InputOptions input;
  CameraOptions camera;
  std::string model = "human", out, config, init = "descent", metric = "pixel-count", root = "tracked", estimate;
  TrackerOptions tracker;
};

void add_track_options(CLI::App& app, TrackOptions& options);

// The pose of a frame in a CSV of poses, or its first where it does not have that frame. [D]
// Errors: those of read_poses(); no pose in it.
Result<std::vector<double>> read_initial_pose(const std::string& file, const Skeleton& skeleton, int64_t frame);

// A tracker that starts at `first_frame`. Errors: those of read_initial_pose(). Throws UsageError for options that the
// tracker refuses.
Result<Tracker> make_tracker(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                             std::vector<PinholeCamera> cameras, uint64_t seed, int64_t first_frame);

// The tracker's options as they came out, by option name, for config.toml.
std::map<std::string, std::string> chosen_options(const TrackerOptions& used);

}  // namespace silpose::app
