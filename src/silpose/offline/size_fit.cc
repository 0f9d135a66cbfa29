#include "silpose/offline/size_fit.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/median.h"
#include "silpose/body/collision_spheres.h"
#include "silpose/body/point_motion.h"

namespace silpose {
namespace {

constexpr double kLowestCamera = 0.2;  // [guess] metres above the floor: below, the floor is seen at too small an angle

}  // namespace

std::optional<SizeFit> fit_size(const BodyModel& body, const PinholeCamera& camera,
                                std::span<const std::vector<double>> poses) {
  const double camera_height = camera.centre_in_world().y();
  if (camera_height < kLowestCamera) return std::nullopt;
  const std::vector<SkinPoint> points = outermost_points(body);
  std::vector<double> factors;
  for (const std::vector<double>& pose : poses) {
    if (pose.empty()) continue;
    const PointMotion motion(body.skeleton, pose);
    double lowest = camera_height;
    for (const SkinPoint& point : points) {
      lowest = std::min(lowest, motion.position(point.joint_idx, point.x_in_joint).y());
    }
    if (camera_height - lowest > 0.05 * camera_height) factors.push_back(camera_height / (camera_height - lowest));
  }
  if (2 * factors.size() <= poses.size()) return std::nullopt;
  const double factor = upper_median(factors);
  for (double& one : factors) one = std::abs(one - factor);
  return SizeFit{factor, 1.4826 * upper_median(std::move(factors))};  // a normal deviation, robustly
}

}  // namespace silpose
