#include "silpose/evaluate/interval_coverage.h"

#include <cmath>

#include "silpose/base/check.h"

namespace silpose {

std::vector<double> pose_difference(const Skeleton& skeleton, std::span<const double> pose,
                                    std::span<const double> truth) {
  const auto num_dofs = static_cast<size_t>(skeleton.num_dofs());
  check(pose.size() == num_dofs && truth.size() == num_dofs, "pose_difference: {} and {} values for {} DOF",
        pose.size(), truth.size(), num_dofs);
  std::vector<double> difference(num_dofs);
  for (size_t d = 0; d < num_dofs; ++d) {
    difference[d] = pose[d] - truth[d];
    if (skeleton.dofs()[d].is_periodic) difference[d] = wrap_angle(difference[d]);
  }
  return difference;
}

std::vector<double> interval_coverage(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& deviations,
                                      double spreads) {
  constexpr double kRounding = 1e-9;
  check(errors.rows() == deviations.rows() && errors.cols() == deviations.cols() && errors.rows() > 0,
        "interval_coverage: errors {} x {}, deviations {} x {}", errors.rows(), errors.cols(), deviations.rows(),
        deviations.cols());
  std::vector<double> coverage(static_cast<size_t>(errors.cols()));
  for (Eigen::Index k = 0; k < errors.cols(); ++k) {
    Eigen::Index inside = 0;
    for (Eigen::Index t = 0; t < errors.rows(); ++t) {
      if (std::abs(errors(t, k)) <= spreads * deviations(t, k) + kRounding) ++inside;
    }
    coverage[static_cast<size_t>(k)] = static_cast<double>(inside) / static_cast<double>(errors.rows());
  }
  return coverage;
}

}  // namespace silpose
