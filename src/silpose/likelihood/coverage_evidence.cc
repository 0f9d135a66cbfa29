// What CoverageLikelihood compares with: observations as cells, and how noisy they are.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "silpose/base/check.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/coverage_raster.h"

namespace silpose {
namespace {

// Numbers that a fit takes from an outline: what they explain is not left in the residual.
constexpr double kFittedNumbers = 15;

}  // namespace

void CoverageEvidence::set_noise(std::span<const double> relative) {
  for (size_t c = 0; c < relative.size(); ++c) {
    if (relative[c] > 0) noise[c] = relative[c] * std::pow(views[c].pixel_unit, 3);
  }
}

double CoverageEvidence::relative_noise(size_t camera_idx) const {
  return noise[camera_idx] / std::pow(views[camera_idx].pixel_unit, 3);
}

std::optional<size_t> CoverageEvidence::first_seen() const {
  const auto seen = std::ranges::find_if(views, [](const View& view) { return view.trust > 0; });
  return seen == views.end() ? std::nullopt : std::optional(static_cast<size_t>(seen - views.begin()));
}

bool CoverageEvidence::has_directions() const {
  return std::ranges::any_of(views,
                             [](const View& view) { return view.keypoints && view.keypoints->num_directions(); });
}

double CoverageEvidence::keypoint_cost(const Skeleton& skeleton, std::span<const double> pose) const {
  double sum = 0;
  for (const View& view : views) {
    if (view.keypoints) sum += view.trust * view.keypoints->cost(skeleton, pose);
  }
  return sum;
}

CoverageEvidence CoverageLikelihood::prepare(std::span<const Observation> observations, Blur widest, Blur narrowest,
                                             EvidenceKind kind) const {
  check(observations.size() == cameras().size(), "CoverageLikelihood: {} observations for {} cameras",
        observations.size(), cameras().size());
  CoverageEvidence evidence;
  evidence.silhouettes = kind != EvidenceKind::kKeypoints;
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& observation = observations[c];
    const PinholeCamera& camera = cameras()[c];
    check(observation.mask.width() == camera.width && observation.mask.height() == camera.height,
          "CoverageLikelihood: mask of {}x{} for camera '{}' of {}x{}", observation.mask.width(),
          observation.mask.height(), camera.name, camera.width, camera.height);
    CoverageEvidence::View& view = evidence.views.emplace_back();
    evidence.noise.push_back(0);
    const Box box = observation.box();
    if (observation.trust.nothing_found || box.empty()) continue;
    view.trust = observation.trust.overall;
    view.keypoints = make_keypoint_term(body(), camera, observation, kind);
    const double extent = std::max(box.height, box.width);
    view.pixel_unit = std::max(extent / CoverageEvidence::kSubjectHeight, 0.25);
    view.outline_length = outline_length(observation.mask);
    evidence.noise.back() = kExactNoise * std::pow(view.pixel_unit, 3);
    for (auto b = static_cast<size_t>(narrowest); b <= static_cast<size_t>(widest); ++b) {
      const int cell = std::max(1, static_cast<int>(std::lround(kBlurSigma[b] * view.pixel_unit)));
      view.rasters[b] = coverage_raster(observation, cell);
    }
  }
  return evidence;
}

std::vector<double> CoverageLikelihood::estimate_noise(const CoverageEvidence& evidence, std::span<const double> pose,
                                                       Scratch& scratch) const {
  std::vector<double> noise = residuals(evidence, Blur::k8, pose, scratch);
  for (size_t c = 0; c < noise.size(); ++c) {
    const CoverageEvidence::View& view = evidence.views[c];
    if (view.trust <= 0 || view.outline_length <= 0) {
      noise[c] = 0;
      continue;
    }
    const double along = 2 * std::sqrt(std::numbers::pi) * view.rasters[static_cast<size_t>(Blur::k8)].cell;
    const double segments = view.outline_length / along;
    const double left = std::max(segments - kFittedNumbers, 0.25 * segments) / segments;
    noise[c] *= along / (view.outline_length * left) / std::pow(view.pixel_unit, 3);
    noise[c] = std::max(noise[c], kLeastNoise);
  }
  return noise;
}

std::vector<double> CoverageLikelihood::least_noise(const CoverageEvidence& evidence,
                                                    std::span<const Eigen::VectorXd> poses, Scratch& scratch) const {
  std::vector<double> least;
  for (const Eigen::VectorXd& pose : poses) {
    const std::vector<double> noise =
        estimate_noise(evidence, {pose.data(), static_cast<size_t>(pose.size())}, scratch);
    if (least.empty()) least = noise;
    for (size_t c = 0; c < noise.size(); ++c) least[c] = std::min(least[c], noise[c]);
  }
  return least;
}

}  // namespace silpose
