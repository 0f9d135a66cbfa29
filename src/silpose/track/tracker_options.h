// TrackerOptions: all options of a tracker: what every tracker has, and those of its filter, which is either a mixture
// of fitted hypotheses or one that samples. Sets of values to start from: tracker_presets.h.
// Threads: values; the tables are constant.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/body/body_model.h"
#include "silpose/body/levels.h"
#include "silpose/geometry/camera.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/pose_likelihood.h"
#include "silpose/motion/motion_model.h"
#include "silpose/motion/proposal.h"
#include "silpose/render/render_backend.h"
#include "silpose/shape/shape_metric.h"

namespace silpose {

// How sampling filters compare silhouettes.
enum class Metric {
  kPixelCount,  // pixels: set in one of both only
  kCoverage,    // parts of pixels: |covered by one - covered by the other|, which motion of a tenth of a pixel changes.
                // At a quarter of the resolution it still locates a body better.
};

enum class Estimate { kMean, kMode, kCluster };

// Where regenerated particles come from: around the estimate, or around the poses that a network recognises.
enum class RegenerateFrom { kRandom, kNetwork };

// The mixture of fitted hypotheses (mixture_filter.h).
struct FittedOptions {
  int num_hypotheses = 4;
  bool smooth = false;  // a batch fit over the clip afterwards; only track_clip() does it
  bool floor = true;    // nothing lies below y = 0; with smoothing, what rests on it does not slide
  bool operator==(const FittedOptions&) const = default;
};

// A particle filter, plain or annealed. The defaults are those of a plain one.
struct SamplingOptions {
  int num_particles = 1000;  // per layer
  int num_layers = 1;        // of annealing; 1: plain
  // Two plain filters in place of one (cormier2019 sect. 2.4): the pose on cropped silhouettes, then the root on whole
  // images.
  bool separate_root = false;
  std::string motion = "diffusion";       // motion/motion_model.h
  double sigma_deg = 4;                   // of a typical rotational DOF per 1/30 s; the others scale with it
  std::string resampling = "systematic";  // filter/resampling.h
  double resample_below = 1;              // of n_eff / N; 1: every step
  double regenerate = 0;                  // fraction of the particles that `comb` regenerates
  RegenerateFrom regenerate_from = RegenerateFrom::kRandom;
  Metric metric = Metric::kPixelCount;
  double sharpness = 100;
  Estimate estimate = Estimate::kMean;
  bool root_fixed = false;  // the six root DOF stay where they started
  bool operator==(const SamplingOptions&) const = default;
};

struct TrackerOptions {
  std::shared_ptr<const BodyModel> body;  // full mesh; the tracker makes its own level of detail
  std::vector<PinholeCamera> cameras;     // [C]
  // How far the subject's size may be from the body's, one standard deviation, relative. One camera cannot separate
  // size from distance, so it is added to the spread; several can.
  double size_deviation = 0;
  std::variant<FittedOptions, SamplingOptions> filter;
  int lod_vertices = kTrackingLevel;  // of the mesh that is compared, smoothed clips: in the end; 0: the body's own
  // What poses are compared by during tracking; also whether starts use silhouettes. Where there are no keypoints,
  // kBoth is the same as kSilhouette.
  EvidenceKind evidence = EvidenceKind::kBoth;
  bool landmarks = false;  // starts use keypoints, where there are any
  uint64_t seed = 1;
  std::optional<std::vector<double>> initial_pose;  // [D]; absent: descent on the first good mask
  // Candidates for the start, for re-initialising the fitted mixture, and for particles that are regenerated from a
  // network; absent: the common poses, and what the keypoints show. Starts with `landmarks` do not use it.
  std::shared_ptr<const Proposal> proposal;

  // What a program may add or replace; nothing, for what the other options say.
  // Evidence besides silhouettes and keypoints, of bodies with the same degrees of freedom: log-likelihoods add up. The
  // fitted mixture needs likelihoods that can be linearised. Filters that sample weigh silhouettes by `sharpness` and
  // keypoints by a fifth, which is less than their likelihood, so that enough particles are left: others need a like
  // share. With separate_root only the filter of the root uses them. Instants without a usable mask coast all the same.
  std::vector<std::shared_ptr<const PoseLikelihood>> likelihoods;
  // Of sampling filters: in place of SamplingOptions::motion and its sigma_deg; in place of ::metric; what they draw
  // silhouettes with. The last two are not used where `evidence` is keypoints alone.
  std::shared_ptr<const MotionModel> motion_model;
  std::shared_ptr<const ShapeMetric> shape_metric;
  MakeRenderBackend make_backend;

  // Null where the filter is of the other kind.
  [[nodiscard]] const FittedOptions* fitted() const { return std::get_if<FittedOptions>(&filter); }
  [[nodiscard]] FittedOptions* fitted() { return std::get_if<FittedOptions>(&filter); }
  [[nodiscard]] const SamplingOptions* sampling() const { return std::get_if<SamplingOptions>(&filter); }
  [[nodiscard]] SamplingOptions* sampling() { return std::get_if<SamplingOptions>(&filter); }
  [[nodiscard]] bool smooths() const { return fitted() != nullptr && fitted()->smooth; }
  [[nodiscard]] bool has_floor() const { return fitted() != nullptr && fitted()->floor; }

  // Errors: throws std::invalid_argument that names the option and its value.
  void check() const;
};

// The options that have a name: of every tracker, and of each filter.
const OptionTable<TrackerOptions>& tracker_option_table();
const OptionTable<FittedOptions>& fitted_option_table();
const OptionTable<SamplingOptions>& sampling_option_table();

// Those of the options' likelihoods that fits use, which can be linearised. Starts are fitted whatever the filter.
std::vector<std::shared_ptr<const PoseLikelihood>> fitted_terms(const TrackerOptions& options);

// What starts are compared by.
EvidenceKind start_evidence(const TrackerOptions& options);

// Candidates for the start: fitted to landmarks where these are used, else the options' proposal, else the common
// poses.
std::shared_ptr<const Proposal> start_proposal(const TrackerOptions& options);

}  // namespace silpose
