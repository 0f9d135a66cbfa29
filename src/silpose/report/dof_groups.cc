#include "silpose/report/dof_groups.h"

#include <algorithm>
#include <span>

namespace silpose {
namespace {

constexpr size_t kMostJoints = 8;  // of a group

// Chains of joints that have DOF, from one fork of such joints to the next.
class Chains {
 public:
  explicit Chains(const Skeleton& skeleton) {
    const auto count = static_cast<size_t>(skeleton.num_joints());
    children_.resize(count);
    moves_.resize(count);
    for (const Dof& dof : skeleton.dofs()) moves_[static_cast<size_t>(dof.joint_idx)] = true;
    std::vector<bool> is_alive = moves_;  // moves itself, or something below it does
    for (size_t j = count; j-- > 0;) {    // parents come first
      const int parent = skeleton.joints()[j].parent_idx;
      if (parent >= 0 && is_alive[j]) is_alive[static_cast<size_t>(parent)] = true;
    }
    for (size_t j = 0; j < count; ++j) {
      const int parent = skeleton.joints()[j].parent_idx;
      if (!is_alive[j]) continue;
      if (parent < 0) {
        roots_.push_back(j);
      } else {
        children_[static_cast<size_t>(parent)].push_back(j);
      }
    }
  }

  std::vector<std::vector<size_t>> list() {
    for (const size_t root : roots_) {
      if (moves_[root]) chains_.push_back({root});
      for (const size_t child : children_[root]) follow(child);
    }
    return std::move(chains_);
  }

 private:
  void follow(size_t joint) {
    std::vector<size_t> chain;
    for (;;) {
      if (moves_[joint]) chain.push_back(joint);
      if (children_[joint].size() != 1) break;
      joint = children_[joint].front();
    }
    if (!chain.empty()) chains_.push_back(std::move(chain));
    for (const size_t child : children_[joint]) follow(child);
  }

  std::vector<bool> moves_;
  std::vector<size_t> roots_;
  std::vector<std::vector<size_t>> children_, chains_;
};

std::string label_of(const Skeleton& skeleton, std::span<const size_t> chain) {
  const auto name = [&](size_t j) -> const std::string& { return skeleton.joints()[j].name; };
  const std::string_view side = side_of(name(chain.front()));
  const bool is_of_one_side =
      std::all_of(chain.begin(), chain.end(), [&](size_t j) { return side_of(name(j)) == side; });
  const auto shown = [&](size_t j) { return std::string(is_of_one_side ? without_side(name(j)) : name(j)); };
  if (chain.size() == 1) return shown(chain.front());
  return shown(chain.front()) + (chain.size() == 2 ? ", " : " to ") + shown(chain.back());
}

}  // namespace

std::string_view side_of(std::string_view name) {
  if (name.starts_with("left_")) return "left";
  if (name.starts_with("right_")) return "right";
  return "";
}

std::vector<std::string> dof_groups(const Skeleton& skeleton) {
  std::vector<std::string> of_joint(static_cast<size_t>(skeleton.num_joints()));
  for (const std::vector<size_t>& chain : Chains(skeleton).list()) {
    const size_t parts = (chain.size() + kMostJoints - 1) / kMostJoints;
    for (size_t part = 0; part < parts; ++part) {
      const size_t begin = chain.size() * part / parts, end = chain.size() * (part + 1) / parts;
      const auto joints = std::span(chain).subspan(begin, end - begin);
      for (const size_t j : joints) of_joint[j] = label_of(skeleton, joints);
    }
  }
  std::vector<std::string> of_dof;
  of_dof.reserve(skeleton.dofs().size());
  for (const Dof& dof : skeleton.dofs()) of_dof.push_back(of_joint[static_cast<size_t>(dof.joint_idx)]);
  return of_dof;
}

}  // namespace silpose
