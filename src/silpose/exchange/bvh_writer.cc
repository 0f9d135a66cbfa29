#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/exchange/bvh.h"
#include "silpose/exchange/unwrapped_euler.h"

namespace silpose {
namespace {

class Writer {
 public:
  explicit Writer(const Clip& clip) : clip_(clip), children_(clip.num_joints()), moves_(clip.num_joints()) {
    const size_t J = clip.num_joints();
    for (size_t j = 0; j < J; ++j) {
      const int parent = clip.joints[j].parent_idx;
      if (parent >= 0) children_[static_cast<size_t>(parent)].push_back(j);
      moves_[j] = parent < 0;
      for (size_t frame = 0; frame < clip.num_frames() && !moves_[j]; ++frame) {
        moves_[j] = (clip.translations[frame * J + j] - clip.joints[j].offset).norm() > 1e-9;
      }
    }
  }

  std::string write() {
    put("HIERARCHY\n");
    for (size_t j = 0; j < clip_.num_joints(); ++j) {
      if (clip_.joints[j].parent_idx < 0) put_joint(j, 0);
    }
    put("MOTION\nFrames: {}\nFrame Time: {:.9f}\n", clip_.num_frames(), 1 / clip_.fps);
    angles_.assign(clip_.num_joints(), {});
    for (size_t frame = 0; frame < clip_.num_frames(); ++frame) put_frame(frame);
    return std::move(text_);
  }

 private:
  template <class... Args>
  void put(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
  }

  void put_joint(size_t j, size_t depth) {
    const Clip::Joint& joint = clip_.joints[j];
    const std::string indent(depth, '\t');
    if (joint.is_end) {
      put("{}End Site\n{}{{\n", indent, indent);
    } else {
      put("{}{} {}\n{}{{\n", indent, joint.parent_idx < 0 ? "ROOT" : "JOINT", joint.name, indent);
    }
    put("{}\tOFFSET {:.6f} {:.6f} {:.6f}\n", indent, joint.offset.x(), joint.offset.y(), joint.offset.z());
    if (!joint.is_end) {
      order_.push_back(j);
      put("{}\tCHANNELS {}{} Zrotation Xrotation Yrotation\n", indent, moves_[j] ? 6 : 3,
          moves_[j] ? " Xposition Yposition Zposition" : "");
      for (const size_t child : children_[j]) put_joint(child, depth + 1);
      if (children_[j].empty()) {
        put("{}\tEnd Site\n{}\t{{\n{}\t\tOFFSET 0.000000 0.000000 0.000000\n{}\t}}\n", indent, indent, indent, indent);
      }
    }
    put("{}}}\n", indent);
  }

  void put_frame(size_t frame) {
    bool first = true;
    const auto put_value = [&](double value) { put("{}{:.6f}", std::exchange(first, false) ? "" : " ", value); };
    for (const size_t j : order_) {
      const size_t at = frame * clip_.num_joints() + j;
      if (moves_[j]) {
        for (const double value : clip_.translations[at]) put_value(value);
      }
      const Eigen::Vector3d angles = angles_[j].next(clip_.rotations[at].normalized().toRotationMatrix());
      for (const double angle : angles) put_value(to_degrees(angle));
    }
    text_ += '\n';
  }

  const Clip& clip_;
  std::vector<std::vector<size_t>> children_;
  std::vector<bool> moves_;    // has position channels
  std::vector<size_t> order_;  // joints depth first, without end sites
  std::vector<SteadyAngles> angles_;
  std::string text_;
};

}  // namespace

Result<void> write_bvh(const std::filesystem::path& path, const Clip& clip) {
  check(!clip.joints.empty() && clip.fps > 0, "write_bvh: {} joints, {} frames per second", clip.num_joints(),
        clip.fps);
  if (clip.num_frames() > 0) (void)clip.world_from_joint(0);  // throws where joints or shapes are out of order
  return write_text_file(path, Writer(clip).write());
}

Clip clip_from_poses(const Skeleton& skeleton, std::span<const std::vector<double>> poses, double fps,
                     std::span<const BodyModel::EndPoint> end_points) {
  check(fps > 0 && std::isfinite(fps), "clip_from_poses: {} frames per second", fps);
  const auto joints = skeleton.joints();
  std::vector<bool> is_leaf(joints.size(), true);
  Clip clip;
  clip.name = skeleton.name();
  clip.fps = fps;
  for (const Joint& joint : joints) {
    clip.joints.push_back({joint.name, joint.parent_idx, joint.offset_in_parent, false});
    if (joint.parent_idx >= 0) is_leaf[static_cast<size_t>(joint.parent_idx)] = false;
  }
  for (const BodyModel::EndPoint& point : end_points) {
    const auto j = static_cast<size_t>(point.joint_idx);
    check(j < joints.size(), "end point '{}' of joint {}", point.name, point.joint_idx);
    if (is_leaf[j]) {
      is_leaf[j] = false;
      clip.joints.push_back({joints[j].name + "_end", point.joint_idx, point.offset_in_joint, true});
    }
  }
  for (const std::vector<double>& pose : poses) {
    check(pose.size() == static_cast<size_t>(skeleton.num_dofs()), "pose of {} values for {} DOF", pose.size(),
          skeleton.num_dofs());
    const std::vector<Rigid3> world_from_joint = skeleton.forward_kinematics(pose);
    for (size_t j = 0; j < clip.joints.size(); ++j) {
      const int parent = clip.joints[j].parent_idx;
      Rigid3 local{Eigen::Matrix3d::Identity(), clip.joints[j].offset};
      if (!clip.joints[j].is_end) {
        local = parent < 0 ? world_from_joint[j]
                           : world_from_joint[static_cast<size_t>(parent)].inverse() * world_from_joint[j];
      }
      clip.rotations.emplace_back(Eigen::Quaterniond(local.rotation).normalized());
      clip.translations.push_back(local.translation);
    }
  }
  return clip;
}

}  // namespace silpose
