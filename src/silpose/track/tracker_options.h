// TrackerOptions: all options of a tracker, and the presets.
// Threads: a value.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/motion/proposal.h"

namespace silpose {

enum class Estimate { kMean, kMode, kCluster };

struct TrackerOptions {
  std::shared_ptr<const BodyModel> body;  // full mesh; the tracker makes its own level of detail
  std::vector<PinholeCamera> cameras;     // [C]
  // How far the subject's size may be from the body's, one standard deviation, relative. One camera cannot separate
  // size from distance, so it is added to the spread; several can.
  double size_deviation = 0;
  std::string preset = "default";  // "default", "accurate" or "thesis"; fills what is left unset below
  // The fitted mixture; unset where a sampling filter is requested.
  std::optional<int> num_hypotheses;
  std::optional<bool> smooth;  // a batch fit over the clip afterwards; only track_clip() does it
  std::optional<bool> floor;   // nothing lies below y = 0; with smoothing, what rests on it does not slide
  // The sampling filters: preset thesis, or any other with one of the first two set.
  std::optional<int> num_particles;            // per layer; set alone it makes the filter plain
  std::optional<int> num_layers;               // 1: plain
  std::optional<std::string> motion;           // motion/motion_model.h
  std::optional<double> sigma_deg;             // of a typical rotational DOF per 1/30 s; the others scale with it
  std::optional<std::string> resampling;       // filter/resampling.h
  double resample_below = 1;                   // of n_eff / N; 1: every step
  std::optional<double> regenerate;            // fraction of the particles that the comb regenerates
  std::optional<std::string> regenerate_from;  // "random": about the estimate; "network": about the poses it recognises
  std::optional<std::string> metric;           // "pixel-count" or "coverage" (likelihood/silhouette_likelihood.h)
  std::optional<double> sharpness;
  std::optional<Estimate> estimate;
  bool root_fixed = false;          // the six root DOF stay where they started
  std::optional<int> lod_vertices;  // of the mesh that is compared, smoothed clips: in the end; 0: the body's own
  uint64_t seed = 1;
  std::optional<std::vector<double>> initial_pose;  // [D]; absent: descent on the first good mask
  // The evidence that poses are compared by during tracking; also whether starts use keypoints, where there are any.
  EvidenceKind evidence = EvidenceKind::kSilhouette;
  bool landmarks = false;
  // Candidates for the start, and for re-initialising the fitted mixture; absent: the common poses.
  std::shared_ptr<const Proposal> proposal;

  // Errors: throws std::invalid_argument that names the option and its value.
  void check() const;

  // The same with everything unset filled in from the preset.
  [[nodiscard]] TrackerOptions resolved() const;
};

// What starts are compared by.
EvidenceKind start_evidence(const TrackerOptions& options);

// Candidates for the start: fitted to landmarks where these are used, else the options' proposal, else the common
// poses.
std::shared_ptr<const Proposal> start_proposal(const TrackerOptions& options, size_t camera_idx);

// The camera whose observation starts use: the first one with keypoints, else the first. Shapes: one observation per
// camera.
size_t start_camera(std::span<const Observation> observations);

}  // namespace silpose
