#include "apps/silpose/track_options.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "silpose/exchange/tables.h"

namespace silpose::app {
namespace {

void add_tracker_options(CLI::App& app, TrackOptions& options) {
  TrackerOptions& tracker = options.tracker;
  app.add_option("--preset", tracker.preset, "default, or thesis: two plain filters, root and pose")
      ->capture_default_str()
      ->check(CLI::IsMember({"default", "thesis"}));
  app.add_option("--particles", tracker.num_particles, "Particles in a layer")->check(CLI::Range(2, 1'000'000));
  app.add_option("--layers", tracker.num_layers, "Annealing layers; 1 is a plain filter")->check(CLI::Range(1, 200));
  app.add_option("--motion", tracker.motion, "How particles move between frames")
      ->check(CLI::IsMember({"diffusion", "first-order-augmented"}));
  app.add_option("--sigma-deg", tracker.sigma_deg, "Noise of a typical joint angle in 1/30 s")
      ->check(within(1e-3, 90));
  app.add_option("--resampling", tracker.resampling, "Which particles go on")
      ->check(CLI::IsMember({"systematic", "comb"}));
  app.add_option("--resample-below", tracker.resample_below, "Only when n_eff is below this part of the particles")
      ->capture_default_str()
      ->check(within(0, 1));
  app.add_option("--regenerate", tracker.regenerate, "Part of the comb's particles that is made anew")
      ->check(within(0, 0.99));
  app.add_option("--sharpness", tracker.sharpness, "How strongly better silhouettes are preferred")
      ->check(within(1e-3, 1e6));
  app.add_option("--metric", options.metric, "How silhouettes are compared")
      ->capture_default_str()
      ->check(CLI::IsMember({"pixel-count"}));
  app.add_option("--root", options.root, "tracked, or fixed where it starts")
      ->capture_default_str()
      ->check(CLI::IsMember({"tracked", "fixed"}));
  app.add_option("--init", options.init, "First pose: descent, or a poses.csv (its row of the first frame)")
      ->capture_default_str();
  app.add_option("--estimate", options.estimate, "Which pose is reported: mean, mode or cluster")
      ->check(CLI::IsMember({"mean", "mode", "cluster"}));
}

}  // namespace

void add_track_options(CLI::App& app, TrackOptions& options) {
  add_input_options(app, options.input);
  app.add_option("--out", options.out, "Directory for the result");
  add_model_option(app, options.model);
  add_camera_options(app, options.camera);
  add_tracker_options(app, options);
  app.add_option("--config", options.config, "Options from a TOML file; the command line wins");
}

Result<std::vector<double>> read_initial_pose(const std::string& file, const Skeleton& skeleton, int64_t frame) {
  const Result<PoseTable> table = read_poses(file, skeleton);
  if (!table) return table.failure();
  if (table->rows.empty()) return error("{}: no pose in it", file);
  for (const PoseTable::Row& row : table->rows) {
    if (row.frame == frame) return row.values;
  }
  return table->rows.front().values;
}

Result<Tracker> make_tracker(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                             std::vector<PinholeCamera> cameras, uint64_t seed, int64_t first_frame) {
  TrackerOptions tracker = options.tracker;
  tracker.body = std::move(body);
  tracker.cameras = std::move(cameras);
  tracker.seed = seed;
  tracker.root_fixed = options.root == "fixed";
  if (options.estimate == "mean") tracker.estimate = Estimate::kMean;
  if (options.estimate == "mode") tracker.estimate = Estimate::kMode;
  if (options.estimate == "cluster") tracker.estimate = Estimate::kCluster;
  if (options.init != "descent") {
    Result<std::vector<double>> pose = read_initial_pose(options.init, tracker.body->skeleton, first_frame);
    if (!pose) return pose.failure();
    tracker.initial_pose = std::move(*pose);
  }
  try {
    return Tracker(tracker);
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(wrong.what());
  }
}

std::map<std::string, std::string> chosen_options(const TrackerOptions& used) {
  std::map<std::string, std::string> chosen;
  const auto keep = [&](const char* name, const auto& value) {
    if (value) chosen[name] = fmt::format("{}", *value);
  };
  keep("particles", used.num_particles);
  keep("layers", used.num_layers);
  keep("motion", used.motion);
  keep("sigma-deg", used.sigma_deg);
  keep("resampling", used.resampling);
  keep("regenerate", used.regenerate);
  keep("sharpness", used.sharpness);
  if (used.estimate) {
    chosen["estimate"] = *used.estimate == Estimate::kMean   ? "mean"
                         : *used.estimate == Estimate::kMode ? "mode"
                                                             : "cluster";
  }
  return chosen;
}

}  // namespace silpose::app
