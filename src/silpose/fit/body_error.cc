#include "silpose/fit/body_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "silpose/body/stretchable.h"

namespace silpose {
namespace {

// [guess] Outline noise, in units of pixel_unit^3. Below kRightBody the body is assumed to be the subject's, above
// kAnyBody for an arbitrary one.
constexpr double kRightBody = 2, kAnyBody = 20;
// Some errors are the same in all frames: the subject is not built as the body is, and a network has a bias for each
// person and view. All frames together then have this share of the information of a single frame.
// [tuned on the experiment `real`: nine in ten joints and knees lie within the claimed 90 %]
constexpr double kSilhouetteWorth = 0.05, kKeypointWorth = 0.35;
constexpr double kFreeInformation = 1e-3;  // [guess] of DOF without a prior: small, so that matrices are invertible

// 0: the body is the subject's, 1: an arbitrary one. By the camera with the least noise: a body that fits one view well
// is not far off.
double wrongness(const CoverageEvidence& evidence) {
  double least = kAnyBody;
  for (size_t c = 0; c < evidence.views.size(); ++c) {
    if (evidence.views[c].trust <= 0) continue;
    least = std::min(least, evidence.relative_noise(c));
  }
  return std::clamp(std::log(least / kRightBody) / std::log(kAnyBody / kRightBody), 0.0, 1.0);
}

}  // namespace

BodyError::BodyError(const BodyModel& body, std::vector<PinholeCamera> cameras, double size_deviation)
    : size_deviation_(size_deviation) {
  auto stretched = std::make_shared<const BodyModel>(stretchable(body));
  deviation_ = body.profile.rest;
  seen_deviation_ = body.profile.rest_if_seen;
  lengths_ = stretch_covariance(stretched->skeleton);
  likelihood_ = std::make_unique<CoverageLikelihood>(std::move(stretched), std::move(cameras));
}

PoseVariances BodyError::variance(const CoverageEvidence& evidence, std::span<const double> pose,
                                  CoverageLikelihood::Scratch& scratch) const {
  PoseVariances result = no_variances(pose.size(), likelihood_->body());
  add_wrong_lengths(evidence, pose, scratch, result);
  const auto is_usable = [](const CoverageEvidence::View& view) { return view.trust > 0; };
  if (std::ranges::count_if(evidence.views, is_usable) == 1) {
    add_wrong_size(likelihood_->cameras()[*evidence.first_seen()], pose, result);
  }
  return result;
}

// A body that is scaled about the camera's centre has the same silhouette.
void BodyError::add_wrong_size(const PinholeCamera& camera, std::span<const double> pose, PoseVariances& result) const {
  if (size_deviation_ <= 0) return;
  const BodyModel& body = likelihood_->body();
  std::vector<double> stretched(pose.begin(), pose.end());
  stretched.resize(static_cast<size_t>(body.skeleton.num_dofs()), 0.0);
  const std::vector<Eigen::Vector3d> landmarks = landmark_positions(body, stretched);
  const Eigen::Vector3d centre = camera.centre_in_world();
  for (size_t l = 0; l < landmarks.size(); ++l) {
    result.landmarks.in_world[l] += (size_deviation_ * (landmarks[l] - centre)).cwiseAbs2();
    result.landmarks.about_root[l] += (size_deviation_ * (landmarks[l] - landmarks.front())).cwiseAbs2();
  }
  const Eigen::Vector3d of_root = size_deviation_ * (landmarks.front() - centre);
  for (size_t d = 0; d < pose.size(); ++d) {
    const bool moves_root = std::ranges::count(body.profile.root_translations, static_cast<int>(d)) > 0;
    if (moves_root) result.dofs[d] += std::pow(body.skeleton.axis_in_parent(static_cast<int>(d)).dot(of_root), 2);
  }
}

void BodyError::add_wrong_lengths(const CoverageEvidence& evidence, std::span<const double> pose,
                                  CoverageLikelihood::Scratch& scratch, PoseVariances& result) const {
  const BodyModel& body = likelihood_->body();
  const auto D = std::ssize(pose), S = lengths_.rows();
  const double wrong = wrongness(evidence);
  if (wrong == 0 || S == 0) return;

  std::vector<double> stretched(pose.begin(), pose.end());
  stretched.resize(static_cast<size_t>(D + S), 0.0);
  const Eigen::MatrixXd hessian = likelihood_->linearise(evidence, Blur::k4, stretched, scratch).hessian;
  const std::vector<double>& deviations = evidence.has_directions() ? seen_deviation_ : deviation_;
  Eigen::VectorXd rest(D);
  for (Eigen::Index d = 0; d < D; ++d) {
    const double deviation = deviations[static_cast<size_t>(d)];
    rest[d] = deviation > 0 ? 1 / (deviation * deviation) : kFreeInformation;
  }
  Eigen::MatrixXd held = hessian.topLeftCorner(D, D);
  held.diagonal() += rest;
  // How the fitted pose changes with the lengths: so that the silhouette changes least.
  Eigen::MatrixXd answer(D + S, S);
  answer.topRows(D) = -held.ldlt().solve(hessian.topRightCorner(D, S));
  answer.bottomRows(S).setIdentity();
  Eigen::MatrixXd covariance = answer * lengths_ * answer.transpose();
  covariance.topLeftCorner(D, D) += correlated_errors(evidence, stretched, hessian.topLeftCorner(D, D), rest, scratch);
  covariance *= wrong;
  for (Eigen::Index d = 0; d < D; ++d) result.dofs[static_cast<size_t>(d)] += std::max(covariance(d, d), 0.0);
  result.landmarks += landmark_variances(body, stretched, covariance);
}

// Covariance of a fit to one frame, whose information is reduced to what all frames together are worth. Errors that are
// the same in all frames do not average out, however long a clip is.
Eigen::MatrixXd BodyError::correlated_errors(const CoverageEvidence& evidence, std::span<const double> stretched,
                                             const Eigen::MatrixXd& information, const Eigen::VectorXd& rest,
                                             CoverageLikelihood::Scratch& scratch) const {
  const Eigen::Index D = rest.size();
  CoverageEvidence of_keypoints = evidence;
  of_keypoints.silhouettes = false;
  const Eigen::MatrixXd by_keypoints =
      likelihood_->linearise(of_keypoints, Blur::k4, stretched, scratch).hessian.topLeftCorner(D, D);
  Eigen::MatrixXd once = kSilhouetteWorth * (information - by_keypoints) + kKeypointWorth * by_keypoints;
  once.diagonal() += rest;
  return once.ldlt().solve(Eigen::MatrixXd::Identity(D, D));
}

}  // namespace silpose
