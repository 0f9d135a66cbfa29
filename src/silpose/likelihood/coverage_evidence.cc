#include "silpose/likelihood/coverage_evidence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace silpose {

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

double CoverageEvidence::energy_of_terms(std::span<const double> pose) const {
  double sum = 0;
  for (const Term& term : terms) {
    const Eigen::Index D = term.likelihood->body().skeleton.num_dofs();
    const StateBatch one = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), D);
    double log_likelihood = 0;
    term.likelihood->add_log_likelihood(*term.evidence, one, {&log_likelihood, 1});
    sum -= 2 * log_likelihood;
  }
  return sum;
}

double CoverageEvidence::add_terms(std::span<const double> pose, Eigen::VectorXd& gradient,
                                   Eigen::MatrixXd& hessian) const {
  double sum = 0;
  for (const Term& term : terms) {
    const Eigen::Index D = term.likelihood->body().skeleton.num_dofs();
    const NormalEquations equations = term.likelihood->linearise(*term.evidence, pose.first(static_cast<size_t>(D)));
    sum += equations.energy;
    gradient.head(D) += equations.gradient;
    hessian.topLeftCorner(D, D) += equations.hessian;
  }
  return sum;
}

double CoverageEvidence::keypoint_cost(const Skeleton& skeleton, std::span<const double> pose) const {
  double sum = 0;
  for (const View& view : views) {
    if (view.keypoints) sum += view.trust * view.keypoints->cost(skeleton, pose);
  }
  return sum;
}

double outline_length(const Observation& observation) {
  const Mask& mask = observation.mask;
  const Mask none(observation.ignored ? 0 : mask.width(), observation.ignored ? 0 : mask.height());
  const Mask& ignored = observation.ignored ? *observation.ignored : none;
  int64_t borders = 0;
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y), out = ignored.row(y);
    uint64_t last = 0, last_out = 0;
    for (size_t w = 0; w < row.size(); ++w) {
      uint64_t change = (row[w] ^ (row[w] << 1 | last)) & ~(out[w] | out[w] << 1 | last_out);
      if (w == 0) change &= ~uint64_t{1};
      if (w + 1 == row.size() && mask.width() % 64 != 0) change &= (uint64_t{1} << (mask.width() % 64)) - 1;
      borders += std::popcount(change);
      last = row[w] >> 63, last_out = out[w] >> 63;
      if (y > 0) borders += std::popcount((row[w] ^ mask.row(y - 1)[w]) & ~(out[w] | ignored.row(y - 1)[w]));
    }
  }
  return static_cast<double>(borders) * 0.78539816339744831;  // steps of a line of random direction are 4 / pi too long
}

}  // namespace silpose
