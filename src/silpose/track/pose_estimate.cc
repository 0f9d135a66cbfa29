#include "silpose/track/pose_estimate.h"

#include "silpose/body/point_motion.h"
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

LandmarkVariances& LandmarkVariances::operator+=(const LandmarkVariances& other) {
  for (size_t l = 0; l < other.in_world.size(); ++l) {
    in_world[l] += other.in_world[l];
    about_root[l] += other.about_root[l];
  }
  return *this;
}

LandmarkVariances no_landmark_variances(size_t count) {
  const std::vector<Eigen::Vector3d> zero(count, Eigen::Vector3d::Zero());
  return {zero, zero};
}

LandmarkVariances landmark_variances(const BodyModel& body, std::span<const double> pose,
                                     const Eigen::MatrixXd& covariance) {
  const PointMotion motion(body.skeleton, pose);
  const auto landmarks = landmark_positions(body, pose);
  const size_t num_joints = motion.world_from_joint().size();
  const Eigen::Matrix3Xd root = motion.jacobian(0, landmarks.front());
  const Eigen::Matrix3Xd root_covariance = root * covariance;
  const auto product = [](const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) -> Eigen::Vector3d {
    return a.cwiseProduct(b).rowwise().sum();
  };
  const Eigen::Vector3d of_root = product(root_covariance, root);
  LandmarkVariances variances;
  for (size_t l = 0; l < landmarks.size(); ++l) {
    const int joint = l < num_joints ? static_cast<int>(l) : body.end_points[l - num_joints].joint_idx;
    const Eigen::Matrix3Xd jacobian = motion.jacobian(joint, landmarks[l]);
    const Eigen::Vector3d own = product(jacobian * covariance, jacobian);
    variances.in_world.emplace_back(own.cwiseMax(0));
    variances.about_root.emplace_back((own - 2 * product(root_covariance, jacobian) + of_root).cwiseMax(0));
  }
  return variances;
}

}  // namespace silpose
