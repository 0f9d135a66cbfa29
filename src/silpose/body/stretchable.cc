#include "silpose/body/stretchable.h"

#include <string_view>
#include <utility>

namespace silpose {
namespace {

std::string_view without_side(std::string_view name) {
  for (const std::string_view side : {"right_", "left_"}) {
    if (name.starts_with(side)) return name.substr(side.size());
  }
  return name;
}

}  // namespace

BodyModel stretchable(const BodyModel& body, const StretchOptions& options) {
  const Skeleton& skeleton = body.skeleton;
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  std::vector<Dof> dofs(skeleton.dofs().begin(), skeleton.dofs().end());
  for (size_t j = 0; j < joints.size(); ++j) {
    const double length = joints[j].offset_in_parent.norm();
    if (joints[j].parent_idx < 0 || length < options.shortest_bone * body.height_m) continue;
    const double limit = 3 * length * (options.size + options.bone);
    joints[j].dof_indices.insert(joints[j].dof_indices.begin(), static_cast<int>(dofs.size()));
    dofs.push_back({.name = joints[j].name + "_length",
                    .joint_idx = static_cast<int>(j),
                    .is_translation = true,
                    .axis = joints[j].offset_in_parent / length,
                    .lower = -limit,
                    .upper = limit,
                    .is_shape = true});
  }
  BodyModel out = body;
  out.skeleton = Skeleton(skeleton.name(), std::move(joints), std::move(dofs));
  return out;
}

std::vector<int> shape_dofs(const Skeleton& skeleton) {
  std::vector<int> indices;
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    if (skeleton.dofs()[static_cast<size_t>(d)].is_shape) indices.push_back(d);
  }
  return indices;
}

Eigen::MatrixXd stretch_covariance(const Skeleton& skeleton, const StretchOptions& options) {
  const std::vector<int> indices = shape_dofs(skeleton);
  const auto S = std::ssize(indices);
  Eigen::MatrixXd covariance(S, S);
  const auto length = [&](Eigen::Index i) {
    return skeleton
        .joints()[static_cast<size_t>(skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(i)])].joint_idx)]
        .offset_in_parent.norm();
  };
  for (Eigen::Index i = 0; i < S; ++i) {
    for (Eigen::Index j = 0; j < S; ++j) {
      const std::string& a = skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(i)])].name;
      const std::string& b = skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(j)])].name;
      double relative = options.size * options.size;
      if (without_side(a) == without_side(b)) relative += options.bone * options.bone;
      if (i == j) relative += options.side * options.side;
      covariance(i, j) = relative * length(i) * length(j);
    }
  }
  return covariance;
}

}  // namespace silpose
