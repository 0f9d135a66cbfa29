#include "silpose/body/collision_spheres.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "silpose/base/parallel.h"

namespace silpose {
namespace {

constexpr size_t kMostTouched = 150;  // vertices of a bone for which a ball is computed
constexpr size_t kMostSpheres = 6;    // of a bone
constexpr double kSmallest = 0.5;     // of a bone's largest sphere
constexpr double kApart = 0.7;        // of a radius: sphere centres of one bone are further apart

// [J] the vertices of each bone.
std::vector<std::vector<uint32_t>> vertices_by_joint(const BodyModel& body) {
  std::vector<std::vector<uint32_t>> by_joint(body.skeleton.joints().size());
  const std::vector<int> main_joint = main_joints(body);
  for (uint32_t v = 0; v < body.rest.vertices.size(); ++v) {
    by_joint[static_cast<size_t>(main_joint[v])].push_back(v);
  }
  return by_joint;
}

// [V] unit vectors that point out.
std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const Face& face : mesh.faces) {
    const Eigen::Vector3f& a = mesh.vertices[face[0]];
    const Eigen::Vector3f area = (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);
    for (const uint32_t v : face) normals[v] += area;
  }
  for (Eigen::Vector3f& normal : normals) normal.normalize();
  return normals;
}

// Radius of the largest ball that touches the skin at `x` from inside and has no vertex within.
float largest_ball(const std::vector<Eigen::Vector3f>& vertices, const Eigen::Vector3f& x,
                   const Eigen::Vector3f& normal) {
  float least = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& vertex : vertices) {
    const Eigen::Vector3f d = x - vertex;
    const float inwards = d.dot(normal);
    if (inwards > 1e-5f) least = std::min(least, d.squaredNorm() / (2 * inwards));
  }
  return least;
}

std::vector<CollisionSphere> spheres_of_joint(const BodyModel& body, int joint_idx, const std::vector<uint32_t>& own,
                                              const std::vector<Eigen::Vector3f>& normals) {
  std::vector<CollisionSphere> balls;
  const size_t stride = (own.size() + kMostTouched - 1) / kMostTouched;
  for (size_t i = 0; i < own.size(); i += stride) {
    const Eigen::Vector3f& x = body.rest.vertices[own[i]];
    const float radius = largest_ball(body.rest.vertices, x, normals[own[i]]);
    if (!std::isfinite(radius)) continue;
    const Eigen::Vector3d centre = (x - radius * normals[own[i]]).cast<double>();
    balls.push_back({joint_idx, body.joint_from_rest[static_cast<size_t>(joint_idx)] * centre, radius});
  }
  std::ranges::stable_sort(balls, std::greater<>{}, &CollisionSphere::radius);
  std::vector<CollisionSphere> kept;
  for (const CollisionSphere& ball : balls) {
    if (kept.size() == kMostSpheres || ball.radius < kSmallest * balls.front().radius) break;
    const bool apart = std::ranges::all_of(kept, [&](const CollisionSphere& other) {
      return (ball.centre_in_joint - other.centre_in_joint).norm() > kApart * other.radius;
    });
    if (apart) kept.push_back(ball);
  }
  return kept;
}

// Where a column of the rest mesh, along z, crosses the skin.
struct Crossing {
  float z = 0;
  int joint_idx = 0;
};
constexpr int kColumns = 200;                                 // along the body's greatest extent
constexpr double kOffMiddleX = 0.4931, kOffMiddleY = 0.5077;  // of a column: no edge of a symmetric mesh lies there

}  // namespace

std::vector<CollisionSphere> collision_spheres(const BodyModel& body) {
  const auto by_joint = vertices_by_joint(body);
  const auto normals = vertex_normals(body.rest);
  std::vector<std::vector<CollisionSphere>> of_joint(by_joint.size());
  parallel_for(by_joint.size(), 1, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      of_joint[j] = spheres_of_joint(body, static_cast<int>(j), by_joint[j], normals);
    }
  });
  std::vector<CollisionSphere> all;
  for (const auto& some : of_joint) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<SkinPoint> outermost_points(const BodyModel& body) {
  const auto by_joint = vertices_by_joint(body);
  std::vector<SkinPoint> points;
  for (size_t j = 0; j < by_joint.size(); ++j) {
    std::vector<uint32_t> chosen;
    for (int k = 0; k < 27 && !by_joint[j].empty(); ++k) {
      const Eigen::Vector3d towards = Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1).cast<double>();
      if (towards.isZero()) continue;
      chosen.push_back(*std::ranges::max_element(by_joint[j], {}, [&](uint32_t v) {
        return towards.normalized().dot(body.joint_from_rest[j].rotation * body.rest.vertices[v].cast<double>());
      }));
    }
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const uint32_t v : chosen) {
      points.push_back({static_cast<int>(j), body.joint_from_rest[j] * body.rest.vertices[v].cast<double>()});
    }
  }
  return points;
}

std::vector<std::optional<Eigen::Vector3d>> segment_centres(const BodyModel& body) {
  const std::vector<Eigen::Vector3f>& vertices = body.rest.vertices;
  Eigen::Vector3f lowest = vertices.front(), highest = vertices.front();
  for (const Eigen::Vector3f& x : vertices) lowest = lowest.cwiseMin(x), highest = highest.cwiseMax(x);
  const float side = (highest - lowest).maxCoeff() / kColumns;
  const int width = static_cast<int>((highest.x() - lowest.x()) / side) + 1;
  const int height = static_cast<int>((highest.y() - lowest.y()) / side) + 1;

  const std::vector<int> joint_of = main_joints(body);
  std::vector<std::vector<Crossing>> columns(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (const Face& face : body.rest.faces) {
    const Eigen::Vector3f &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (area == 0) continue;
    const auto column = [&](float x, float from) { return static_cast<int>(std::floor((x - from) / side)); };
    const auto [left, right] = std::minmax({a.x(), b.x(), c.x()});
    const auto [bottom, top] = std::minmax({a.y(), b.y(), c.y()});
    for (int row = column(bottom, lowest.y()); row <= std::min(column(top, lowest.y()), height - 1); ++row) {
      for (int col = column(left, lowest.x()); col <= std::min(column(right, lowest.x()), width - 1); ++col) {
        const float x = lowest.x() + (static_cast<float>(col) + static_cast<float>(kOffMiddleX)) * side;
        const float y = lowest.y() + (static_cast<float>(row) + static_cast<float>(kOffMiddleY)) * side;
        const float of_b = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / area;
        const float of_c = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / area;
        if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
        const size_t nearest = of_b > 0.5f ? 1 : of_c > 0.5f ? 2 : 0;
        columns[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(col)].push_back(
            {a.z() + of_b * (b.z() - a.z()) + of_c * (c.z() - a.z()), joint_of[face[nearest]]});
      }
    }
  }

  const size_t J = body.skeleton.joints().size();
  std::vector<double> mass(J, 0);
  std::vector<Eigen::Vector3d> moment(J, Eigen::Vector3d::Zero());
  for (size_t i = 0; i < columns.size(); ++i) {
    std::vector<Crossing>& crossings = columns[i];
    std::ranges::sort(crossings, {}, &Crossing::z);
    const size_t row = i / static_cast<size_t>(width), col = i % static_cast<size_t>(width);
    const double x = lowest.x() + (static_cast<double>(col) + kOffMiddleX) * side;
    const double y = lowest.y() + (static_cast<double>(row) + kOffMiddleY) * side;
    for (size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const double half = (crossings[k + 1].z - crossings[k].z) / 2;
      for (const auto& [joint_idx, z] : {std::pair(crossings[k].joint_idx, crossings[k].z + half / 2),
                                         std::pair(crossings[k + 1].joint_idx, crossings[k + 1].z - half / 2)}) {
        mass[static_cast<size_t>(joint_idx)] += half;
        moment[static_cast<size_t>(joint_idx)] += half * Eigen::Vector3d(x, y, z);
      }
    }
  }
  std::vector<std::optional<Eigen::Vector3d>> centres(J);
  for (size_t j = 0; j < J; ++j) {
    if (mass[j] > 0) centres[j] = body.joint_from_rest[j] * (moment[j] / mass[j]);
  }
  return centres;
}

}  // namespace silpose
