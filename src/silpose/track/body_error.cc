#include "silpose/track/body_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "silpose/body/stretchable.h"
#include "silpose/motion/noise.h"
#include "silpose/track/pose_estimate.h"

namespace silpose {
namespace {

// Outline noise (in units of pixel_unit^3) up to which the body counts as right, and from which on as any other's.
constexpr double kRightBody = 2, kAnyBody = 20;

// 0 to 1, the cleanest camera's: what fits from one side may still be wrong, but not by much.
double wrongness(const CoverageEvidence& evidence) {
  double least = kAnyBody;
  for (size_t c = 0; c < evidence.views.size(); ++c) {
    if (evidence.views[c].trust <= 0) continue;
    least = std::min(least, evidence.relative_noise(c));
  }
  return std::clamp(std::log(least / kRightBody) / std::log(kAnyBody / kRightBody), 0.0, 1.0);
}

}  // namespace

BodyError::BodyError(const BodyModel& body, std::vector<PinholeCamera> cameras) {
  auto stretched = std::make_shared<const BodyModel>(stretchable(body));
  deviation_ = pose_deviation(body.skeleton);
  lengths_ = stretch_covariance(stretched->skeleton);
  likelihood_ = std::make_unique<CoverageLikelihood>(std::move(stretched), std::move(cameras));
}

BodyError::Variance BodyError::variance(const CoverageEvidence& evidence, std::span<const double> pose,
                                        CoverageLikelihood::Scratch& scratch) const {
  const BodyModel& body = likelihood_->body();
  const auto D = std::ssize(pose), S = lengths_.rows();
  const size_t num_landmarks = static_cast<size_t>(body.skeleton.num_joints()) + body.end_points.size();
  Variance result{std::vector<double>(pose.size(), 0.0),
                  std::vector<Eigen::Vector3d>(num_landmarks, Eigen::Vector3d::Zero())};
  const double wrong = wrongness(evidence);
  if (wrong == 0 || S == 0) return result;

  std::vector<double> stretched(pose.begin(), pose.end());
  stretched.resize(static_cast<size_t>(D + S), 0.0);
  const Eigen::MatrixXd hessian = likelihood_->linearise(evidence, Blur::k4, stretched, scratch).hessian;
  Eigen::MatrixXd held = hessian.topLeftCorner(D, D);
  for (Eigen::Index d = 0; d < D; ++d) {
    const double deviation = deviation_[static_cast<size_t>(d)];
    held(d, d) += deviation > 0 ? 1 / (deviation * deviation) : 1e-3;
  }
  // The pose answers to a change of lengths so that the silhouette stays where it is, as far as it can.
  Eigen::MatrixXd answer(D + S, S);
  answer.topRows(D) = -held.ldlt().solve(hessian.topRightCorner(D, S));
  answer.bottomRows(S).setIdentity();
  const Eigen::MatrixXd covariance = wrong * answer * lengths_ * answer.transpose();
  for (Eigen::Index d = 0; d < D; ++d) result.dofs[static_cast<size_t>(d)] = std::max(covariance(d, d), 0.0);
  result.landmarks = landmark_variances(body, stretched, covariance);
  for (Eigen::Vector3d& variance : result.landmarks) variance = variance.cwiseMax(0);
  return result;
}

}  // namespace silpose
