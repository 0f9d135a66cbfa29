#include "silpose/fit/depth_ambiguity_moves.h"

#include <limits>
#include <optional>
#include <utility>

#include "silpose/fit/limb_reach.h"
#include "silpose/fit/limb_variants.h"

namespace silpose {
namespace {

// Takes the depth out of distances about a point.
Eigen::Matrix3d across(const Eigen::Vector3d& camera_centre, const Eigen::Vector3d& point) {
  const Eigen::Vector3d ray = (point - camera_centre).normalized();
  return Eigen::Matrix3d::Identity() - ray * ray.transpose();
}

}  // namespace

std::vector<double> exchanged_in_image(const BodyModel& body, const Limb& a, const Limb& b,
                                       std::span<const double> pose, const Eigen::Vector3d& camera_centre, Rng& rng) {
  constexpr int kTries = 12;      // [guess] of a limb: from the other's angles, from its own, and at random
  constexpr double kNear = 0.05;  // [guess] metres: of a try that will do
  const Skeleton& skeleton = body.skeleton;
  const std::vector<LimbPoint> of_a = limb_points(body, a), of_b = limb_points(body, b);
  if (of_a.size() != of_b.size() || of_a.size() < 2) return {};
  const std::vector<Eigen::Vector3d> x_a = positions(skeleton, of_a, pose), x_b = positions(skeleton, of_b, pose);
  const Eigen::Matrix3d seen = across(camera_centre, (x_a.front() + x_b.front()) / 2);
  std::vector<double> variant(pose.begin(), pose.end());
  exchange(variant, a, b);
  const auto reach = [&](const Limb& limb, std::span<const LimbPoint> points,
                         std::span<const Eigen::Vector3d> targets) {
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> best;
    for (int i = 0; i < kTries && least > kNear; ++i) {
      std::vector<double> attempt = variant;
      for (const int d : limb.dofs) {
        const auto at = static_cast<size_t>(d);
        if (i == 1) attempt[at] = pose[at];
        if (i > 1) attempt[at] = rng.uniform(skeleton.dofs()[at].lower, skeleton.dofs()[at].upper);
      }
      const double off = reach_for(skeleton, limb, points, targets, seen, attempt);
      if (off < least) least = off, best = std::move(attempt);
    }
    variant = std::move(best);
  };
  reach(a, of_a, x_b);
  reach(b, of_b, x_a);
  return variant;
}

std::vector<double> turned_in_image(const BodyModel& body, std::span<const double> pose, double angle,
                                    const Eigen::Vector3d& camera_centre) {
  const Skeleton& skeleton = body.skeleton;
  const std::optional<int> turn = body.profile.heading;
  if (!turn) return {};
  std::vector<double> variant(pose.begin(), pose.end());
  double& heading = variant[static_cast<size_t>(*turn)];
  heading = wrap_angle(heading + angle);
  for (const Limb& limb : body.profile.limbs) {
    const std::vector<LimbPoint> points = limb_points(body, limb);
    if (points.size() < 2) continue;
    const std::vector<Eigen::Vector3d> x = positions(skeleton, points, pose);
    reach_for(skeleton, limb, points, x, across(camera_centre, x.front()), variant);
  }
  return variant;
}

std::vector<std::vector<double>> depth_ambiguity_moves(const BodyModel& body, std::span<const double> pose,
                                                       const Eigen::Vector3d& camera_centre, Rng& rng) {
  const double kTurn = to_radians(40);
  const std::vector<Limb>& limbs = body.profile.limbs;
  std::vector<std::vector<double>> moves;
  std::vector<double> all(pose.begin(), pose.end());
  for (const auto& [a, b] : body.profile.limb_pairs) {
    std::vector<double> one = exchanged_in_image(body, limbs[a], limbs[b], pose, camera_centre, rng);
    if (one.empty()) continue;
    for (const size_t limb : {a, b}) {
      for (const int d : limbs[limb].dofs) all[static_cast<size_t>(d)] = one[static_cast<size_t>(d)];
    }
    moves.push_back(std::move(one));
  }
  if (moves.size() > 1) moves.push_back(std::move(all));
  for (const double angle : {-kTurn, kTurn}) moves.push_back(turned_in_image(body, pose, angle, camera_centre));
  moves.push_back(mirrored_in_depth(body, pose, camera_centre));
  std::erase_if(moves, [](const std::vector<double>& move) { return move.empty(); });
  return moves;
}

}  // namespace silpose
