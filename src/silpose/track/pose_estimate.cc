#include "silpose/track/pose_estimate.h"

#include "silpose/filter/estimate.h"

namespace silpose {
namespace {

// [guess] Particles within this many frames' noise of each other, in the root mean square over DOF, are one cluster.
constexpr double kClusterBandwidth = 2;

}  // namespace

std::vector<int> periodic_dofs(const Skeleton& skeleton) {
  return find_dofs(skeleton, [](const Dof& dof) { return dof.is_periodic; });
}

std::vector<double> pose_estimate(const Skeleton& skeleton, const ParticleSet& particles, Estimate kind,
                                  std::span<const double> scale) {
  const Eigen::Index D = skeleton.num_dofs();
  const StateBatch poses = particles.states.leftCols(D);
  const std::vector<double> weights = particles.weights();
  const std::vector<int> circular = periodic_dofs(skeleton);
  std::vector<double> pose;
  switch (kind) {
    case Estimate::kMean:
      pose = weighted_mean(poses, weights, circular);
      break;
    case Estimate::kMode: {
      const Eigen::RowVectorXd best = poses.row(mode_index(weights));
      pose.assign(best.begin(), best.end());
      break;
    }
    case Estimate::kCluster:
      pose = cluster_estimate(poses, weights, scale.first(static_cast<size_t>(D)), kClusterBandwidth, circular).mean;
      break;
  }
  skeleton.clamp(pose);
  return pose;
}

}  // namespace silpose
