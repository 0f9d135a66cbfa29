#include "silpose/track/tracker_options.h"

#include <cmath>

#include "silpose/base/check.h"
#include "silpose/body/levels.h"
#include "silpose/filter/resampling.h"
#include "silpose/motion/common_poses.h"
#include "silpose/motion/motion_model.h"
#include "silpose/track/landmark_proposal.h"

namespace silpose {

TrackerOptions TrackerOptions::resolved() const {
  const bool thesis = preset == "thesis";
  const bool accurate = preset == "accurate";
  TrackerOptions all = *this;
  if (!thesis && !num_particles && !num_layers) {
    if (!all.num_hypotheses) all.num_hypotheses = accurate ? 8 : 4;
    if (!all.smooth) all.smooth = accurate;
    if (!all.floor) all.floor = true;
    if (!all.lod_vertices) all.lod_vertices = accurate ? 0 : kTrackingLevel;
    return all;
  }
  if (!all.num_layers) all.num_layers = thesis || all.num_particles ? 1 : 10;
  if (!all.num_particles) all.num_particles = *all.num_layers == 1 ? 1000 : 500;
  if (!all.motion) all.motion = "diffusion";
  // Layers add noise again and again: what a plain filter needs once would blur them.
  if (!all.sigma_deg) all.sigma_deg = *all.num_layers == 1 ? 4 : 2;
  if (!all.resampling) all.resampling = thesis ? "comb" : "systematic";
  if (!all.regenerate) all.regenerate = thesis ? 0.2 : 0.0;
  if (!all.regenerate_from) all.regenerate_from = "random";
  if (!all.metric) all.metric = "pixel-count";
  if (!all.sharpness) all.sharpness = 100;
  if (!all.estimate) all.estimate = Estimate::kMean;
  if (!all.smooth) all.smooth = false;
  if (!all.floor) all.floor = false;
  if (!all.lod_vertices) all.lod_vertices = kSamplingLevel;
  return all;
}

void TrackerOptions::check() const {
  const auto require = [](bool condition, const std::string& message) { silpose::check(condition, "{}", message); };
  require(body != nullptr, "no body");
  require(!cameras.empty(), "no camera");
  require(preset == "default" || preset == "accurate" || preset == "thesis",
          fmt::format("preset '{}' is not default, accurate or thesis", preset));
  const TrackerOptions all = resolved();
  if (all.num_hypotheses) {
    require(!all.num_particles && !all.num_layers && preset != "thesis",
            "hypotheses are fitted: they go neither with particles and layers nor with preset thesis");
    require(*all.num_hypotheses >= 1 && *all.num_hypotheses <= 64,
            fmt::format("{} hypotheses, not within 1..64", *all.num_hypotheses));
    require(!all.motion && !all.sigma_deg && !all.resampling && !all.regenerate && !all.regenerate_from &&
                !all.metric && !all.sharpness,
            "motion, sigma, resampling, regenerate, regenerate from, metric and sharpness are of the sampling filters: "
            "give "
            "particles or "
            "layers");
    require(!all.estimate && !root_fixed && resample_below == 1,
            "estimate, a fixed root and resample below are of the sampling filters: give particles or layers");
  } else {
    require(*all.num_particles >= 2 && *all.num_particles <= 1'000'000,
            fmt::format("{} particles, not within 2..1000000", *all.num_particles));
    require(*all.num_layers >= 1 && *all.num_layers <= 200,
            fmt::format("{} layers, not within 1..200", *all.num_layers));
    require(preset != "thesis" || *all.num_layers == 1, "preset thesis has one layer");
    require(std::isfinite(*all.sigma_deg) && *all.sigma_deg > 0 && *all.sigma_deg <= 90,
            fmt::format("sigma {} degrees, not within (0, 90]", *all.sigma_deg));
    require(*all.regenerate_from == "random" || *all.regenerate_from == "network",
            fmt::format("regenerate from '{}' is not random or network", *all.regenerate_from));
    require(
        *all.regenerate_from == "random" || (*all.regenerate > 0 && *all.resampling == "comb"),
        "regenerate from network: nothing is regenerated; give --resampling comb and --regenerate, or preset thesis");
    require(*all.metric == "pixel-count" || *all.metric == "coverage",
            fmt::format("metric '{}' is not pixel-count or coverage", *all.metric));
    require(std::isfinite(*all.sharpness) && *all.sharpness > 0,
            fmt::format("sharpness {} is not a positive number", *all.sharpness));
    require(!*all.smooth && !*all.floor,
            "smooth and floor are of the fitted mixture: they go with neither particles nor preset thesis");
    const auto resampler = make_resampler(*all.resampling, *all.regenerate);
    require(resampler.ok(), resampler.ok() ? "" : resampler.error().message);
    const auto model = make_motion_model(*all.motion, body->skeleton, body->profile);
    require(model.ok(), model.ok() ? "" : model.error().message);
  }
  require(std::isfinite(resample_below) && resample_below >= 0 && resample_below <= 1,
          fmt::format("resample below {}, not within 0..1", resample_below));
  require(*all.lod_vertices == 0 || *all.lod_vertices >= 100,
          fmt::format("{} vertices, not at least 100", *all.lod_vertices));
  require(std::isfinite(size_deviation) && size_deviation >= 0 && size_deviation < 1,
          fmt::format("size deviation {}, not within [0, 1)", size_deviation));
  const auto num_dofs = static_cast<size_t>(body->skeleton.num_dofs());
  require(!initial_pose || initial_pose->size() == num_dofs,
          fmt::format("initial pose of {} numbers for {} DOF", initial_pose ? initial_pose->size() : 0, num_dofs));
}

EvidenceKind start_evidence(const TrackerOptions& options) {
  if (options.evidence == EvidenceKind::kKeypoints) return options.evidence;
  return options.landmarks ? EvidenceKind::kBoth : EvidenceKind::kSilhouette;
}

size_t start_camera(std::span<const Observation> observations) {
  for (size_t c = 0; c < observations.size(); ++c) {
    if (!observations[c].keypoints_2d.empty() && !observations[c].box().empty()) return c;
  }
  return 0;
}

std::shared_ptr<const Proposal> start_proposal(const TrackerOptions& options, size_t camera_idx) {
  if (options.landmarks) return std::make_shared<const LandmarkProposal>(options.body, options.cameras[camera_idx]);
  if (options.proposal) return options.proposal;
  return std::make_shared<const CommonPoses>(options.body->skeleton, options.body->profile);
}

}  // namespace silpose
