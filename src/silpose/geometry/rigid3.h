// Rigid3: a rigid transform (rotation, then translation), named target_from_source: x_in_target = T * x_in_source.
// Threads: a value.
#pragma once

#include <Eigen/Geometry>

namespace silpose {

struct Rigid3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Rigid3 inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

inline Eigen::Vector3d operator*(const Rigid3& t, const Eigen::Vector3d& x) { return t.rotation * x + t.translation; }

// c_from_a = c_from_b * b_from_a
inline Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
  return {c_from_b.rotation * b_from_a.rotation, c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double to_radians(double degrees) { return degrees * (kPi / 180); }
inline constexpr double to_degrees(double radians) { return radians * (180 / kPi); }

// The angle in [-pi, pi) that differs from `radians` by whole turns.
double wrap_angle(double radians);

}  // namespace silpose
