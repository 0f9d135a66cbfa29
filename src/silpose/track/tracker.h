// Tracker: the method. One step a frame: predict, weigh by silhouette, resample or anneal, estimate. No I/O.
// Presets: `thesis`, two plain filters for root and pose (cormier2019 sect. 2.4; martinez2008); `default`, one annealed
// filter over root and pose together (deutscher2005).
// Threads: one thread steps a tracker; a step itself uses all cores and gives the same result on any number.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/filter/state_batch.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/frame.h"
#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/motion/proposal.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

enum class Estimate { kMean, kMode, kCluster };

struct TrackerOptions {
  std::shared_ptr<const BodyModel> body;       // full mesh; the tracker makes its own level of detail
  std::vector<PinholeCamera> cameras;          // [C]
  std::string preset = "default";              // "default" or "thesis"; fills what is left unset below
  std::optional<int> num_particles;            // per layer
  std::optional<int> num_layers;               // 1: plain
  std::optional<std::string> motion;           // motion/motion_model.h
  std::optional<double> sigma_deg;             // of a typical rotational DOF per 1/30 s; the others scale with it
  std::optional<std::string> resampling;       // filter/resampling.h
  double resample_below = 1;                   // of n_eff / N; 1: every step
  std::optional<double> regenerate;            // fraction of the comb
  std::optional<double> sharpness;
  std::optional<Estimate> estimate;
  bool root_fixed = false;                     // the six root DOF stay where they started
  int lod_vertices = 2000;
  uint64_t seed = 1;
  std::optional<std::vector<double>> initial_pose;  // [D]; absent: descent on the first good mask
  std::shared_ptr<const Proposal> proposal;    // candidates for the start and for regeneration; absent: common poses
  // Errors: throws std::invalid_argument that names the option and its value.
  void check() const;
};

// What one step did.
struct StepReport {
  int64_t frame_idx = 0;
  int64_t time_ns = 0;
  enum class State { kWaiting, kInitialised, kTracked, kCoasted } state = State::kWaiting;
  std::vector<double> pose;               // [D] the estimate (empty while waiting)
  std::vector<double> mode;               // [D] the best particle
  std::vector<double> spread;             // [D] weighted standard deviation
  std::vector<Eigen::Vector3d> landmark_spread;  // [J + E] metres, as body's landmark_positions
  double effective_sample_size = 0;
  double visual_accuracy = 0;             // intersection over union in the first camera's image; 0 when coasted
  std::vector<Trust> trust;               // [C]
  std::vector<Mask> observed;             // [C] the masks that were used
  struct Seconds { double segment = 0, propagate = 0, likelihood = 0, resample = 0; } seconds;
  [[nodiscard]] double time_s() const { return static_cast<double>(time_ns) * 1e-9; }
};

class Tracker {
 public:
  // Errors: throws std::invalid_argument as TrackerOptions::check().
  explicit Tracker(TrackerOptions options);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  // Tracks one instant from masks. Shapes: one observation a camera. Times must grow.
  StepReport step(std::span<const Observation> observations, int64_t frame_idx, int64_t time_ns);

  // The same from pictures: segmented with an online background model, one a camera, that the tracker keeps.
  StepReport step(const Frame& frame);

  [[nodiscard]] const TrackerOptions& options() const;  // with everything unset filled in
  // The current particles [N, D] and their log weights [N].
  [[nodiscard]] const StateBatch& particles() const;
  [[nodiscard]] std::span<const double> log_weights() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace silpose
