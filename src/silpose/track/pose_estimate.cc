#include "silpose/track/pose_estimate.h"

#include "silpose/filter/estimate.h"

namespace silpose {
namespace {

// Particles within this many frames' noise of each other, in the root mean square over DOF, are one cluster.
constexpr double kClusterBandwidth = 2;

}  // namespace

std::vector<int> periodic_dofs(const Skeleton& skeleton) {
  std::vector<int> dofs;
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    if (skeleton.dofs()[static_cast<size_t>(d)].is_periodic) dofs.push_back(d);
  }
  return dofs;
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

std::vector<Eigen::Vector3d> landmark_variances(const BodyModel& body, std::span<const double> pose,
                                                const Eigen::MatrixXd& covariance) {
  const auto world_from_joint = body.skeleton.forward_kinematics(pose);
  const auto landmarks = landmark_positions(body, pose);
  const size_t num_joints = world_from_joint.size();
  std::vector<Eigen::Vector3d> variances;
  for (size_t l = 0; l < landmarks.size(); ++l) {
    const int joint = l < num_joints ? static_cast<int>(l) : body.end_points[l - num_joints].joint_idx;
    const Eigen::Matrix3Xd jacobian = body.skeleton.point_jacobian(pose, world_from_joint, joint, landmarks[l]);
    variances.emplace_back((jacobian * covariance).cwiseProduct(jacobian).rowwise().sum());
  }
  return variances;
}

}  // namespace silpose
