#include "silpose/track/tracker_options.h"

#include <cmath>

#include "silpose/base/check.h"
#include "silpose/filter/resampling.h"
#include "silpose/fit/landmark_proposal.h"
#include "silpose/motion/common_poses.h"
#include "silpose/motion/motion_model.h"

namespace silpose {
namespace {

constexpr int kFewestVertices = 100;  // [guess] fewer have no hands and feet

void check_filter(const FittedOptions& fitted) { fitted_option_table().check(fitted); }

void check_filter(const SamplingOptions& sampling) {
  sampling_option_table().check(sampling);
  check(!sampling.separate_root || sampling.num_layers == 1, "layers: {}, but the thesis' two filters are plain: 1",
        sampling.num_layers);
  check(
      sampling.regenerate_from == RegenerateFrom::kRandom || (sampling.regenerate > 0 && sampling.resampling == "comb"),
      "regenerate-from: network, but nothing is regenerated: it needs resampling comb and regenerate above 0");
}

}  // namespace

const OptionTable<TrackerOptions>& tracker_option_table() {
  static const OptionTable<TrackerOptions> kTable = {
      "Every tracker",
      {{"vertices", &TrackerOptions::lod_vertices, between(0, 1'000'000),
        "About how many of the body's vertices are compared; 0: all. Passes before the smoothing use 2500 at most"},
       {"evidence",
        &TrackerOptions::evidence,
        {{"silhouette", EvidenceKind::kSilhouette},
         {"landmarks", EvidenceKind::kKeypoints},
         {"both", EvidenceKind::kBoth}},
        "What poses are compared by: the silhouette; landmarks, which are the body's keypoints found by a network; or "
        "both, where there are some"}}};
  return kTable;
}

const OptionTable<FittedOptions>& fitted_option_table() {
  static const OptionTable<FittedOptions> kTable = {
      "Fitted hypotheses (presets default and accurate)",
      {{"hypotheses", &FittedOptions::num_hypotheses, between(1, 64), "Hypotheses (possible poses) kept at a time"},
       {"smooth", &FittedOptions::smooth, "Of a recorded clip: track in both directions, then fit all frames at once"},
       {"floor", &FittedOptions::floor,
        "The floor of a calibrated camera is y = 0: nothing lies below; with smoothing, what rests on it does not "
        "slide"}}};
  return kTable;
}

const OptionTable<SamplingOptions>& sampling_option_table() {
  static const OptionTable<SamplingOptions> kTable = {
      "Sampling filters (preset thesis, or with particles or layers)",
      {{"particles", &SamplingOptions::num_particles, between(2, 1'000'000), "Particles per layer"},
       {"layers", &SamplingOptions::num_layers, between(1, 200), "Annealing layers; 1 is a plain filter"},
       {"motion", &SamplingOptions::motion, words_from(motion_model_names()), "How particles move between frames"},
       {"sigma-deg", &SamplingOptions::sigma_deg, between(1e-3, 90), "Noise of a typical joint angle in 1/30 s"},
       {"resampling", &SamplingOptions::resampling, words_from(resampler_names()), "Which particles survive"},
       {"resample-below", &SamplingOptions::resample_below, between(0, 1),
        "Resample only when n_eff is below this fraction of the particles; 1: always"},
       {"regenerate", &SamplingOptions::regenerate, between(0, 0.99),
        "Fraction of the particles that the comb regenerates"},
       {"regenerate-from",
        &SamplingOptions::regenerate_from,
        {{"random", RegenerateFrom::kRandom}, {"network", RegenerateFrom::kNetwork}},
        "Where regenerated particles come from: random (around the estimate) or network (around the poses that it "
        "recognises)"},
       {"sharpness", &SamplingOptions::sharpness, between(1e-3, 1e6), "How strongly better silhouettes are preferred"},
       {"metric",
        &SamplingOptions::metric,
        {{"pixel-count", Metric::kPixelCount}, {"coverage", Metric::kCoverage}},
        "How silhouettes are compared: pixel-count (pixels that differ) or coverage (how much of each; finer, slower)"},
       {"root", &SamplingOptions::root_fixed, {{"tracked", false}, {"fixed", true}}, "Whether the root moves"},
       {"estimate",
        &SamplingOptions::estimate,
        {{"mean", Estimate::kMean}, {"mode", Estimate::kMode}, {"cluster", Estimate::kCluster}},
        "Which pose is reported"}}};
  return kTable;
}

void TrackerOptions::check() const {
  silpose::check(body != nullptr, "no body");
  silpose::check(!cameras.empty(), "no camera");
  tracker_option_table().check(*this);
  std::visit([](const auto& of_filter) { check_filter(of_filter); }, filter);
  silpose::check(lod_vertices == 0 || lod_vertices >= kFewestVertices, "vertices: {} is neither 0 nor at least {}",
                 lod_vertices, kFewestVertices);
  silpose::check(std::isfinite(size_deviation) && size_deviation >= 0 && size_deviation < 1,
                 "size deviation: {} is not a number from 0 to below 1", size_deviation);
  const auto num_dofs = static_cast<size_t>(body->skeleton.num_dofs());
  for (const auto& likelihood : likelihoods) {
    silpose::check(likelihood != nullptr, "likelihoods: one is missing");
    silpose::check(std::cmp_equal(likelihood->body().skeleton.num_dofs(), num_dofs),
                   "likelihoods: one is of a body of {} DOF, not {}", likelihood->body().skeleton.num_dofs(), num_dofs);
    silpose::check(fitted() == nullptr || likelihood->can_linearise(),
                   "likelihoods: the fitted mixture needs ones that can be linearised (PoseLikelihood::linearise)");
  }
  silpose::check(fitted() == nullptr || (!motion_model && !shape_metric && !make_backend),
                 "motion model, shape metric and backend are for filters that sample, not for the fitted mixture");
  silpose::check(!initial_pose || initial_pose->size() == num_dofs, "initial pose: {} numbers for {} DOF",
                 initial_pose ? initial_pose->size() : 0, num_dofs);
}

std::vector<std::shared_ptr<const PoseLikelihood>> fitted_terms(const TrackerOptions& options) {
  std::vector<std::shared_ptr<const PoseLikelihood>> terms = options.likelihoods;
  std::erase_if(terms, [](const auto& likelihood) { return !likelihood->can_linearise(); });
  return terms;
}

EvidenceKind start_evidence(const TrackerOptions& options) {
  if (options.evidence == EvidenceKind::kKeypoints) return options.evidence;
  return options.landmarks ? EvidenceKind::kBoth : EvidenceKind::kSilhouette;
}

std::shared_ptr<const Proposal> start_proposal(const TrackerOptions& options) {
  if (options.landmarks) return std::make_shared<const LandmarkProposal>(options.body);
  if (options.proposal) return options.proposal;
  return std::make_shared<const CommonPoses>(options.body->skeleton, options.body->profile);
}

}  // namespace silpose
