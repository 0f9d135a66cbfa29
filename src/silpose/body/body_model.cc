#include "silpose/body/body_model.h"

#include <algorithm>
#include <array>
#include <limits>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// A joint's skinning transform as four columns of four floats (the fourth unused): one SIMD register each.
struct Columns {
  std::array<Eigen::Vector4f, 4> c;
};

Columns columns(const Rigid3& world_from_rest) {
  Columns out;
  for (int k = 0; k < 3; ++k) out.c[k] << world_from_rest.rotation.col(k).cast<float>(), 0;
  out.c[3] << world_from_rest.translation.cast<float>(), 0;
  return out;
}

}  // namespace

void skin_vertices(const BodyModel& body, std::span<const double> pose, std::span<Rigid3> world_from_joint,
                   std::span<Eigen::Vector3f> vertices) {
  const size_t num_vertices = body.rest.vertices.size();
  const size_t num_joints = static_cast<size_t>(body.skeleton.num_joints());
  check(vertices.size() == num_vertices, "skin_vertices: room for {} vertices, not {}", vertices.size(), num_vertices);
  body.skeleton.forward_kinematics(pose, world_from_joint);

  std::array<Columns, 32> few;  // a human fits: nothing is allocated
  std::vector<Columns> many(num_joints > few.size() ? num_joints : 0);
  Columns* world_from_rest = many.empty() ? few.data() : many.data();
  for (size_t j = 0; j < num_joints; ++j) {
    world_from_rest[j] = columns(world_from_joint[j] * body.joint_from_rest[j]);
  }

  const uint32_t* row = body.skin.row_start.data();
  const uint16_t* joint = body.skin.joint_idx.data();
  const float* weight = body.skin.weight.data();
  const auto skin = [&](size_t v) -> Eigen::Vector4f {
    const Eigen::Vector3f& x = body.rest.vertices[v];
    uint32_t i = row[v];
    const uint32_t end = row[v + 1];
    const Columns& first = world_from_rest[joint[i]];
    if (end - i == 1) return first.c[0] * x[0] + first.c[1] * x[1] + (first.c[2] * x[2] + first.c[3]);
    const float w = weight[i];
    Eigen::Vector4f c0 = first.c[0] * w, c1 = first.c[1] * w, c2 = first.c[2] * w, c3 = first.c[3] * w;
    for (++i; i < end; ++i) {
      const Columns& m = world_from_rest[joint[i]];
      const float wi = weight[i];
      c0 += m.c[0] * wi;
      c1 += m.c[1] * wi;
      c2 += m.c[2] * wi;
      c3 += m.c[3] * wi;
    }
    return c0 * x[0] + c1 * x[1] + (c2 * x[2] + c3);
  };
  if (num_vertices == 0) return;
  // Four floats are stored for each vertex: the fourth lands on the next one, which is written afterwards.
  float* out = vertices[0].data();
  for (size_t v = 0; v + 1 < num_vertices; ++v) Eigen::Map<Eigen::Vector4f>(out + 3 * v) = skin(v);
  vertices[num_vertices - 1] = skin(num_vertices - 1).head<3>();
}

std::vector<Eigen::Vector3f> skin_vertices(const BodyModel& body, std::span<const double> pose) {
  std::vector<Rigid3> world_from_joint(body.skeleton.joints().size());
  std::vector<Eigen::Vector3f> vertices(body.rest.vertices.size());
  skin_vertices(body, pose, world_from_joint, vertices);
  return vertices;
}

std::vector<int> main_joints(const BodyModel& body) {
  std::vector<int> joints;
  joints.reserve(body.rest.vertices.size());
  const auto weights = body.skin.weight.begin();
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    const auto most = std::max_element(weights + body.skin.row_start[v], weights + body.skin.row_start[v + 1]);
    joints.push_back(body.skin.joint_idx[static_cast<size_t>(most - weights)]);
  }
  return joints;
}

std::vector<std::string> landmark_names(const BodyModel& body) {
  std::vector<std::string> names;
  for (const Joint& joint : body.skeleton.joints()) names.push_back(joint.name);
  for (const BodyModel::EndPoint& end_point : body.end_points) names.push_back(end_point.name);
  return names;
}

std::vector<Eigen::Vector3d> landmark_positions(const BodyModel& body, std::span<const double> pose) {
  const std::vector<Rigid3> world_from_joint = body.skeleton.forward_kinematics(pose);
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(world_from_joint.size() + body.end_points.size());
  for (const Rigid3& transform : world_from_joint) positions.push_back(transform.translation);
  for (const BodyModel::EndPoint& end_point : body.end_points) {
    positions.push_back(world_from_joint[end_point.joint_idx] * end_point.offset_in_joint);
  }
  return positions;
}

double furthest_apart(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b) {
  double furthest = 0;
  for (size_t i = 0; i < a.size(); ++i) furthest = std::max(furthest, (a[i] - b[i]).norm());
  return furthest;
}

std::vector<double> standing_pose(const BodyModel& body) {
  std::vector<double> pose(body.skeleton.dofs().size(), 0.0);
  const auto height_by = [&](int d) { return body.skeleton.axis_in_parent(d).y(); };
  const auto goes_up = [&](int d) { return height_by(d) != 0; };
  if (std::ranges::none_of(body.profile.root_translations, goes_up) || body.rest.vertices.empty()) return pose;
  float lowest = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& x : skin_vertices(body, pose)) lowest = std::min(lowest, x.y());
  for (const int d : body.profile.root_translations) {
    if (goes_up(d)) pose[d] = height_by(d) * -lowest;
  }
  return pose;
}

}  // namespace silpose
