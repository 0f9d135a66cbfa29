#include "silpose/likelihood/silhouette_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

// What differs over the sum of both areas. A body that is not seen at all shares nothing with what was observed.
double area_distance(const OutlineRenderer::Counts& counts, int64_t observed_area) {
  const int64_t sum = counts.model + observed_area;
  return sum == 0 ? 1.0 : static_cast<double>(sum - 2 * counts.both) / static_cast<double>(sum);
}

int64_t sum_of(const ByteImage& covered) {
  return std::accumulate(covered.pixels().begin(), covered.pixels().end(), int64_t{0});
}

// Leaves out of the view what its observation ignores: whole raster pixels, of coverages also those that are ignored in
// part.
void ignore(Evidence::View& view, const Mask& ignored) {
  if (view.covered.empty()) {
    view.ignored = resample_mask(ignored, view.window);
    view.observed = without(std::move(view.observed), view.ignored);
    return;
  }
  view.ignored_coverage = resample_coverage(ignored, view.window, kFullCoverage);
  const auto covered = view.covered.pixels(), out = view.ignored_coverage.pixels();
  for (size_t i = 0; i < covered.size(); ++i) {
    if (out[i] > 0) covered[i] = 0, out[i] = kFullCoverage;
  }
}

// So that the samples of a whole picture fit into a raster.
double largest_scale(const PinholeCamera& camera) {
  constexpr double kMostSamples = 1 << 29;  // [definition]
  return std::sqrt(kMostSamples / kFullCoverage / camera.width / camera.height);
}

// [guess] Silhouettes weigh by `sharpness`, which is far less than their likelihood; so do keypoints, or few particles
// would be left.
constexpr double kKeypointShare = 0.2;

}  // namespace

void LikelihoodOptions::check() const {
  silpose::check(std::isfinite(sharpness) && sharpness > 0, "sharpness {} is not a positive number", sharpness);
  silpose::check(resolution >= 16 && resolution <= 1024, "resolution {} is not within 16..1024", resolution);
}

SilhouetteLikelihood::SilhouetteLikelihood(std::vector<std::shared_ptr<const BatchRenderer>> renderers,
                                           LikelihoodOptions options)
    : renderers_(std::move(renderers)), options_(options) {
  options_.check();
  check(!renderers_.empty(), "SilhouetteLikelihood: no renderer");
  for (const auto& renderer : renderers_) {
    check(&renderer->body() == &renderers_.front()->body(), "SilhouetteLikelihood: renderers of different bodies");
  }
}

Evidence SilhouetteLikelihood::prepare(std::span<const Observation> observations) const {
  check(observations.size() == renderers_.size(), "SilhouetteLikelihood: {} observations for {} cameras",
        observations.size(), renderers_.size());
  Evidence evidence;
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& observation = observations[c];
    const PinholeCamera& camera = renderers_[c]->camera();
    check(observation.mask.width() == camera.width && observation.mask.height() == camera.height,
          "SilhouetteLikelihood: mask of {}x{} for camera '{}' of {}x{}", observation.mask.width(),
          observation.mask.height(), camera.name, camera.width, camera.height);
    Evidence::View view;
    const Box box = observation.box();
    if (!observation.trust.nothing_found && !box.empty()) {
      if (options_.comparison == Comparison::kCropped) {
        view.window = window_of(box, options_.resolution, options_.resolution);
      } else {
        // Never enlarged: there is nothing to see between the pixels of a small subject.
        const double longer_side = std::max({box.width, box.height, 1});
        double scale = std::min(1.0, options_.resolution / longer_side);
        if (options_.metric == Metric::kCoverage) scale = std::min(scale, largest_scale(camera));
        view.window = window_of_image(camera.width, camera.height, scale);
      }
      if (options_.metric == Metric::kCoverage) {
        view.covered = resample_coverage(observation.mask, view.window, kFullCoverage);
      } else {
        view.observed = resample_mask(observation.mask, view.window);
      }
      if (observation.ignored && options_.comparison == Comparison::kImage) {
        check_sizes(observation);
        ignore(view, *observation.ignored);
      }
      view.area = view.covered.empty() ? view.observed.count() : sum_of(view.covered);
      view.trust = view.area > 0 ? observation.trust.overall : 0;
      // Cropped silhouettes carry no information about the position, nor do image places of a pose that is elsewhere.
      if (view.trust > 0) {
        view.keypoints = make_keypoint_term(body(), camera, observation, options_.evidence,
                                            options_.comparison == Comparison::kImage);
      }
    }
    evidence.views.push_back(std::move(view));
  }
  return evidence;
}

void SilhouetteLikelihood::accumulate(const Evidence& evidence, const StateBatch& states, bool weighted,
                                      std::span<double> out) const {
  const auto num_states = static_cast<size_t>(states.rows());
  check(out.size() == num_states, "SilhouetteLikelihood: {} outputs for {} states", out.size(), num_states);
  check(evidence.views.size() == renderers_.size(), "SilhouetteLikelihood: evidence of {} cameras for {}",
        evidence.views.size(), renderers_.size());
  const auto num_dofs = static_cast<size_t>(body().skeleton.num_dofs());
  check(static_cast<size_t>(states.cols()) >= num_dofs, "SilhouetteLikelihood: states of {} columns, body of {} DOF",
        states.cols(), num_dofs);
  std::fill(out.begin(), out.end(), 0.0);
  const BatchView batch{states.data(), num_states, num_dofs, static_cast<size_t>(states.cols())};
  std::vector<OutlineRenderer::Counts> counts(num_states);
  for (size_t c = 0; c < renderers_.size(); ++c) {
    const Evidence::View& view = evidence.views[c];
    if (view.trust <= 0) continue;
    const BatchRenderer& renderer = *renderers_[c];
    if (options_.metric == Metric::kCoverage) {
      if (options_.comparison == Comparison::kCropped) {
        renderer.coverages_cropped(batch, view.covered, counts);
      } else {
        renderer.coverages(batch, view.window, view.covered, counts);
      }
    } else if (options_.comparison == Comparison::kCropped) {
      renderer.counts_cropped(batch, view.observed, counts);
    } else {
      renderer.counts(batch, view.window, view.observed, counts);
    }
    if (view.ignored.width() > 0 || !view.ignored_coverage.empty()) {
      std::vector<OutlineRenderer::Counts> unseen(num_states);
      if (options_.metric == Metric::kCoverage) {
        renderer.coverages(batch, view.window, view.ignored_coverage, unseen);
      } else {
        renderer.counts(batch, view.window, view.ignored, unseen);
      }
      for (size_t n = 0; n < num_states; ++n) counts[n].model -= unseen[n].both;
    }
    for (size_t n = 0; n < num_states; ++n) {
      out[n] += (weighted ? view.trust : 1.0) * area_distance(counts[n], view.area);
    }
  }
}

void SilhouetteLikelihood::distances(const Evidence& evidence, const StateBatch& states, std::span<double> out) const {
  accumulate(evidence, states, false, out);
  const auto seen =
      std::count_if(evidence.views.begin(), evidence.views.end(), [](const auto& v) { return v.trust > 0; });
  for (double& distance : out) distance = seen > 0 ? distance / static_cast<double>(seen) : 0;
}

void SilhouetteLikelihood::log_likelihood(const Evidence& evidence, const StateBatch& states,
                                          std::span<double> out) const {
  accumulate(evidence, states, true, out);
  const bool silhouettes = options_.evidence != EvidenceKind::kKeypoints;
  for (double& value : out) value *= silhouettes ? -options_.sharpness : 0;
  const Skeleton& skeleton = body().skeleton;
  for (const Evidence::View& view : evidence.views) {
    if (!view.keypoints) continue;
    parallel_for(out.size(), 64, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) {
        const std::span pose(states.row(static_cast<Eigen::Index>(n)).data(), skeleton.dofs().size());
        out[n] -= kKeypointShare * 0.5 * view.trust * view.keypoints->cost(skeleton, pose);
      }
    });
  }
}

SilhouetteLikelihood::Derivative SilhouetteLikelihood::derivative(const Evidence& evidence,
                                                                  std::span<const double> pose,
                                                                  std::span<const double> steps) const {
  const auto num_dofs = static_cast<Eigen::Index>(body().skeleton.num_dofs());
  check(std::ssize(pose) == num_dofs && std::ssize(steps) == num_dofs,
        "SilhouetteLikelihood: pose of {} and steps of {} numbers for {} DOF", pose.size(), steps.size(), num_dofs);
  const Eigen::Map<const Eigen::RowVectorXd> centre(pose.data(), num_dofs);
  StateBatch states = centre.replicate(2 * num_dofs + 1, 1);
  for (Eigen::Index d = 0; d < num_dofs; ++d) {
    check(steps[d] > 0, "SilhouetteLikelihood: step {} of DOF {}", steps[d], d);
    states(2 * d + 1, d) += steps[d];
    states(2 * d + 2, d) -= steps[d];
  }
  std::vector<double> values(states.rows());
  log_likelihood(evidence, states, values);
  Derivative result{values[0], Eigen::VectorXd(num_dofs)};
  for (Eigen::Index d = 0; d < num_dofs; ++d) {
    result.gradient[d] = (values[2 * d + 1] - values[2 * d + 2]) / (2 * steps[d]);
  }
  return result;
}

}  // namespace silpose
