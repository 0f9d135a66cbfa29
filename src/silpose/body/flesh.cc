#include "silpose/body/flesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "silpose/base/parallel.h"

namespace silpose {
namespace {

constexpr size_t kMostTouched = 150;  // vertices of a bone that a ball is sought for
constexpr size_t kMostSpheres = 6;    // of a bone
constexpr double kSmallest = 0.5;     // of a bone's largest sphere
constexpr double kApart = 0.7;        // of a radius: sphere centres of one bone are further apart

// [J] the vertices of each bone.
std::vector<std::vector<uint32_t>> vertices_by_joint(const BodyModel& body) {
  std::vector<std::vector<uint32_t>> by_joint(body.skeleton.joints().size());
  for (uint32_t v = 0; v < body.rest.vertices.size(); ++v) {
    uint32_t most = body.skin.row_start[v];
    for (uint32_t i = most; i < body.skin.row_start[v + 1]; ++i) {
      if (body.skin.weight[i] > body.skin.weight[most]) most = i;
    }
    by_joint[body.skin.joint_idx[most]].push_back(v);
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

std::vector<FleshSphere> spheres_of_joint(const BodyModel& body, int joint_idx, const std::vector<uint32_t>& own,
                                          const std::vector<Eigen::Vector3f>& normals) {
  std::vector<FleshSphere> balls;
  const size_t stride = (own.size() + kMostTouched - 1) / kMostTouched;
  for (size_t i = 0; i < own.size(); i += stride) {
    const Eigen::Vector3f& x = body.rest.vertices[own[i]];
    const float radius = largest_ball(body.rest.vertices, x, normals[own[i]]);
    if (!std::isfinite(radius)) continue;
    const Eigen::Vector3d centre = (x - radius * normals[own[i]]).cast<double>();
    balls.push_back({joint_idx, body.joint_from_rest[static_cast<size_t>(joint_idx)] * centre, radius});
  }
  std::ranges::stable_sort(balls, std::greater<>{}, &FleshSphere::radius);
  std::vector<FleshSphere> kept;
  for (const FleshSphere& ball : balls) {
    if (kept.size() == kMostSpheres || ball.radius < kSmallest * balls.front().radius) break;
    const bool apart = std::ranges::all_of(kept, [&](const FleshSphere& other) {
      return (ball.centre_in_joint - other.centre_in_joint).norm() > kApart * other.radius;
    });
    if (apart) kept.push_back(ball);
  }
  return kept;
}

}  // namespace

std::vector<FleshSphere> flesh_spheres(const BodyModel& body) {
  const auto by_joint = vertices_by_joint(body);
  const auto normals = vertex_normals(body.rest);
  std::vector<std::vector<FleshSphere>> of_joint(by_joint.size());
  parallel_for(by_joint.size(), 1, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      of_joint[j] = spheres_of_joint(body, static_cast<int>(j), by_joint[j], normals);
    }
  });
  std::vector<FleshSphere> all;
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

}  // namespace silpose
