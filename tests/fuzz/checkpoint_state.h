// A state as checkpoints hold them (base/state_bytes.h): every kind of member that there is.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silpose::fuzz {

struct State {
  enum class Kind { kFirst, kSecond } kind = Kind::kFirst;
  bool flag = false;
  std::vector<std::vector<double>> poses;
  std::deque<int64_t> areas;
  std::optional<std::string> name;
  std::vector<std::pair<std::string, std::string>> lines;
  Eigen::MatrixXd matrix;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::vector<Eigen::VectorXd> vectors;

  static auto members(auto& s) {
    return std::tie(s.kind, s.flag, s.poses, s.areas, s.name, s.lines, s.matrix, s.point, s.vectors);
  }
};

}  // namespace silpose::fuzz
