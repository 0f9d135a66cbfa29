#include "silpose/motion/common_poses.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

constexpr int kNumHeadings = 8;  // [guess]

}  // namespace

CommonPoses::CommonPoses(const Skeleton& skeleton, const RigProfile& profile) {
  check(!profile.poses.empty(), "CommonPoses: the rig's profile has no poses");
  const int num_headings = profile.heading ? kNumHeadings : 1;
  std::vector<std::vector<double>> found;
  for (const auto& [name, named] : profile.poses) {
    check(std::ssize(named) == skeleton.num_dofs(), "CommonPoses: pose '{}' of {} values for {} DOF", name,
          named.size(), skeleton.num_dofs());
    for (int heading = 0; heading < num_headings; ++heading) {
      std::vector<double> pose = named;
      if (profile.heading) pose[static_cast<size_t>(*profile.heading)] = to_radians(360.0 * heading / kNumHeadings);
      skeleton.clamp(pose);
      if (std::find(found.begin(), found.end(), pose) != found.end()) continue;
      found.push_back(std::move(pose));
      names_.push_back(name);
    }
  }
  poses_.resize(static_cast<Eigen::Index>(found.size()), skeleton.num_dofs());
  for (size_t k = 0; k < found.size(); ++k) {
    std::copy(found[k].begin(), found[k].end(), poses_.row(static_cast<Eigen::Index>(k)).data());
  }
}

Proposed CommonPoses::propose(const ProposalContext&, int num_candidates, Rng& rng) const {
  check(num_candidates >= 0, "CommonPoses: {} candidates", num_candidates);
  if (num_candidates == 0 || num_candidates >= poses_.rows()) return {poses_};
  std::vector<Eigen::Index> order(static_cast<size_t>(poses_.rows()));
  std::iota(order.begin(), order.end(), 0);
  StateBatch chosen(num_candidates, poses_.cols());
  for (Eigen::Index k = 0; k < num_candidates; ++k) {
    const auto at = static_cast<size_t>(k);
    std::swap(order[at], order[at + rng.index(order.size() - at)]);
    chosen.row(k) = poses_.row(order[at]);
  }
  return {std::move(chosen)};
}

}  // namespace silpose
