#include "silpose/body/default_profile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace silpose {
namespace {

using Eigen::Vector2d;

constexpr int kDirections = 8;
constexpr int kCells = 256;            // of the grid, along the longest side
constexpr double kOnFloor = 0.02;      // [guess] of the body's size: flesh that is as low stands on the floor
constexpr double kPersonSize_m = 1.7;  // whose deviations tree_profile() assumes

// Marks the cells whose middle lies in the triangle. `covered`: rows of kCells.
void fill(const Vector2d& a, const Vector2d& b, const Vector2d& c, std::vector<bool>& covered) {
  const auto first = [](double low) { return std::max(0, static_cast<int>(std::ceil(low - 0.5))); };
  const auto last = [](double high) { return std::min(kCells - 1, static_cast<int>(std::floor(high - 0.5))); };
  const int y_end = last(std::max({a.y(), b.y(), c.y()}));
  for (int row = first(std::min({a.y(), b.y(), c.y()})); row <= y_end; ++row) {
    const double y = row + 0.5;
    double low = kCells, high = 0;
    for (const auto& [p, q] : {std::pair(a, b), {b, c}, {c, a}}) {
      if ((p.y() < y) == (q.y() < y)) continue;
      const double x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
      low = std::min(low, x), high = std::max(high, x);
    }
    for (int x = first(low); x <= last(high); ++x) covered[static_cast<size_t>(row) * kCells + x] = true;
  }
}

double size_of(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& x : mesh.vertices) box.extend(x);
  return box.isEmpty() ? 0 : static_cast<double>(box.sizes().maxCoeff());
}

// The last joints of the limbs whose flesh comes as low as the floor, in the zero pose.
std::vector<int> contacts_of(const BodyModel& body, std::span<const Limb> limbs) {
  const std::vector<double> pose(body.skeleton.dofs().size(), 0.0);
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
  const std::vector<int> main = main_joints(body);
  float lowest = std::numeric_limits<float>::infinity();
  std::vector<float> lowest_of(body.skeleton.joints().size(), lowest);
  for (size_t v = 0; v < vertices.size(); ++v) {
    lowest = std::min(lowest, vertices[v].y());
    for (int j = main[v]; j >= 0; j = body.skeleton.joints()[j].parent_idx) {
      lowest_of[j] = std::min(lowest_of[j], vertices[v].y());
    }
  }
  std::vector<int> contacts;
  const auto near = static_cast<float>(kOnFloor * size_of(body.rest));
  for (const Limb& limb : limbs) {
    if (lowest_of[limb.joints.back()] <= lowest + near) contacts.push_back(limb.joints.back());
  }
  return contacts;
}

}  // namespace

double mean_silhouette_area(const BodyModel& body, std::span<const double> pose) {
  if (body.rest.faces.empty()) return 0;
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
  double sum = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * kPi * k / kDirections;
    Eigen::AlignedBox2d box;
    std::vector<Vector2d> seen;
    for (const Eigen::Vector3f& x : vertices) {
      const Eigen::Vector3d at = x.cast<double>();
      seen.emplace_back(std::cos(angle) * at.x() - std::sin(angle) * at.z(), at.y());
      box.extend(seen.back());
    }
    const double cell = box.sizes().maxCoeff() / kCells;
    if (!(cell > 0)) continue;
    for (Vector2d& x : seen) x = (x - box.min()) / cell;
    std::vector<bool> covered(static_cast<size_t>(kCells) * kCells, false);
    for (const Face& face : body.rest.faces) fill(seen[face[0]], seen[face[1]], seen[face[2]], covered);
    sum += static_cast<double>(std::ranges::count(covered, true)) * cell * cell;
  }
  return sum / kDirections;
}

RigProfile default_profile(const BodyModel& body) {
  RigProfile profile = tree_profile(body.skeleton);
  for (const BodyModel::EndPoint& end : body.end_points) profile.landmarks.push_back({end.name});
  if (body.rest.vertices.empty()) return profile;
  const double scale = size_of(body.rest) / kPersonSize_m;
  for (size_t d = 0; d < profile.noise.size(); ++d) {
    if (!body.skeleton.dofs()[d].is_translation) continue;
    profile.noise[d] *= scale;
    profile.acceleration[d] *= scale;
  }
  profile.contact_joints = contacts_of(body, profile.limbs);
  const std::vector<double> pose(body.skeleton.dofs().size(), 0.0);
  if (body.height_m > 0) profile.silhouette_area = mean_silhouette_area(body, pose) / (body.height_m * body.height_m);
  return profile;
}

}  // namespace silpose
