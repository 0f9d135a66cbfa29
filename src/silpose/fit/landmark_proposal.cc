#include "silpose/fit/landmark_proposal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/levenberg_marquardt.h"
#include "silpose/base/parallel.h"
#include "silpose/likelihood/keypoint_term.h"

namespace silpose {
namespace {

constexpr int kMostIterations = 40;                     // [guess]
constexpr SmallestGain kSmallestGain = {1e-3, 1e-4};    // [guess] of the cost
constexpr double kLongestTurn = 0.35, kLongestWay = 1;  // [guess] of one step: radians, metres
constexpr double kRegularisation = 1e-6;                // [guess] added to the diagonal: small, for invertible matrices
constexpr double kFarWorse = 25;    // [guess] poses whose cost is so far above the best are not proposed
constexpr double kSamePose = 0.05;  // [guess] metres: of two poses whose joints are all nearer, one is proposed

struct Fit {
  Eigen::VectorXd pose;
  double sum = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  [[nodiscard]] double cost() const { return sum; }
};

// Cost of a pose: of its keypoints, and of its deviation from rest.
class Problem {
 public:
  Problem(const BodyModel& body, const KeypointTerm& term)
      : skeleton_(body.skeleton),
        term_(term),
        deviation_(term.num_directions() > 0 ? body.profile.rest_if_seen : body.profile.rest) {}

  [[nodiscard]] Fit at(Eigen::VectorXd pose) const {
    const Eigen::Index D = pose.size();
    Fit fit{std::move(pose), 0, Eigen::VectorXd::Zero(D), Eigen::MatrixXd::Zero(D, D)};
    fit.sum = term_.add(skeleton_, {fit.pose.data(), static_cast<size_t>(D)}, 1, fit.gradient, fit.hessian);
    for (Eigen::Index d = 0; d < D; ++d) {
      const double deviation = deviation_[static_cast<size_t>(d)];
      if (deviation == 0) continue;
      const double off = fit.pose[d] / deviation;
      fit.sum += off * off;
      fit.gradient[d] += off / deviation;
      fit.hessian(d, d) += 1 / (deviation * deviation);
    }
    return fit;
  }

  [[nodiscard]] std::optional<Fit> step(const Fit& from, double damping) const {
    Eigen::MatrixXd normal = from.hessian;
    normal.diagonal() *= 1 + damping;
    normal.diagonal().array() += kRegularisation;
    Eigen::VectorXd way = normal.ldlt().solve(-from.gradient);
    if (!way.allFinite()) return std::nullopt;
    double longest = 1;
    for (Eigen::Index d = 0; d < way.size(); ++d) {
      const Dof& dof = skeleton_.dofs()[static_cast<size_t>(d)];
      longest = std::max(longest, std::abs(way[d]) / (dof.is_translation ? kLongestWay : kLongestTurn));
    }
    Eigen::VectorXd pose = from.pose + way / longest;
    skeleton_.clamp({pose.data(), static_cast<size_t>(pose.size())});
    return at(std::move(pose));
  }

 private:
  const Skeleton& skeleton_;
  const KeypointTerm& term_;
  std::vector<double> deviation_;
};

}  // namespace

size_t start_camera(std::span<const Observation> observations) {
  for (size_t c = 0; c < observations.size(); ++c) {
    if (!observations[c].keypoints_2d.empty() && !observations[c].box().empty()) return c;
  }
  return 0;
}

LandmarkProposal::LandmarkProposal(std::shared_ptr<const BodyModel> body)
    : body_(std::move(body)), common_(body_->skeleton, body_->profile) {}

Proposed LandmarkProposal::propose(const ProposalContext& context, int num_candidates, Rng& rng) const {
  check(num_candidates >= 0, "LandmarkProposal: {} candidates", num_candidates);
  check(!context.observations.empty() && context.observations.size() == context.cameras.size(),
        "LandmarkProposal: {} observations for {} cameras", context.observations.size(), context.cameras.size());
  const size_t c = start_camera(context.observations);
  const Observation& observation = context.observations[c];
  const PinholeCamera& camera = context.cameras[c];
  const KeypointTerm term(*body_, camera, observation, {.places = 1});
  const Box box = observation.box();
  if (!term.determines_pose() || box.empty()) return common_.propose(context, num_candidates, rng);

  // At the distance at which the body covers as much as the mask, in the middle of its box.
  const double depth = body_->height_m * camera.fy /
                       std::sqrt(1 / body_->profile.silhouette_area * static_cast<double>(observation.mask.count()));
  const Eigen::Vector2d middle(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  const Eigen::Vector3d root = camera.cam_from_world.inverse() * Eigen::Vector3d(camera.ray_from_pixel(middle) * depth);
  const Problem problem(*body_, term);
  const StateBatch& poses = common_.poses();
  std::vector<Fit> fits(static_cast<size_t>(poses.rows()));
  parallel_for(fits.size(), 4, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      Eigen::VectorXd pose = poses.row(static_cast<Eigen::Index>(k)).transpose();
      place_root(body_->skeleton, body_->profile, {pose.data(), static_cast<size_t>(pose.size())}, root);
      fits[k] = problem.at(std::move(pose));
      levenberg_marquardt(fits[k], kMostIterations, kSmallestGain,
                          [&](const Fit& from, double damping) { return problem.step(from, damping); });
    }
  });
  std::ranges::stable_sort(fits, {}, &Fit::sum);
  const double worst = fits.front().sum + kFarWorse;
  std::vector<std::vector<Eigen::Vector3d>> kept;
  std::erase_if(fits, [&](const Fit& fit) {
    if (fit.sum > worst) return true;
    auto x = landmark_positions(*body_, {fit.pose.data(), static_cast<size_t>(fit.pose.size())});
    if (std::ranges::any_of(kept, [&](const auto& other) { return furthest_apart(x, other) < kSamePose; })) return true;
    kept.push_back(std::move(x));
    return false;
  });
  if (num_candidates > 0) fits.resize(std::min(fits.size(), static_cast<size_t>(num_candidates)));
  StateBatch chosen(std::ssize(fits), poses.cols());
  for (size_t k = 0; k < fits.size(); ++k) chosen.row(static_cast<Eigen::Index>(k)) = fits[k].pose.transpose();
  return {std::move(chosen)};
}

}  // namespace silpose
