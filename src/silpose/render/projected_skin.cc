#include "silpose/render/projected_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr size_t kLanes = 4;

std::span<const uint16_t> joints_of(const SkinWeights& skin, size_t vertex) {
  return std::span(skin.joint_idx).subspan(skin.row_start[vertex], skin.row_start[vertex + 1] - skin.row_start[vertex]);
}

}  // namespace

ProjectedSkin::ProjectedSkin(const BodyModel& body, const PinholeCamera& camera) : body_(&body), camera_(&camera) {
  const SkinWeights& skin = body.skin;
  const size_t num_vertices = body.rest.vertices.size();
  check(skin.row_start.size() == num_vertices + 1, "ProjectedSkin: {} vertices, weights of {}", num_vertices,
        skin.row_start.size());
  std::vector<uint32_t> order(num_vertices);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, [&](uint32_t a, uint32_t b) {
    return std::ranges::lexicographical_compare(joints_of(skin, a), joints_of(skin, b));
  });

  std::vector<uint32_t> slot_of_vertex(num_vertices);
  for (size_t first = 0; first < num_vertices; first += kLanes) {
    const auto begin = static_cast<uint32_t>(entries_.size());
    for (size_t lane = 0; lane < kLanes; ++lane) {
      // Lanes past the end repeat the last vertex, so that they change neither bounds nor what is seen.
      const size_t position = std::min(first + lane, num_vertices - 1);
      const uint32_t vertex = order[position];
      vertex_of_slot_.push_back(vertex);
      if (first + lane < num_vertices) slot_of_vertex[vertex] = static_cast<uint32_t>(position);
      const Eigen::Vector3f& rest = body.rest.vertices[vertex];
      for (uint32_t i = skin.row_start[vertex]; i < skin.row_start[vertex + 1]; ++i) {
        auto joint = std::find(entry_joint_.begin() + begin, entry_joint_.end(), skin.joint_idx[i]);
        if (joint == entry_joint_.end()) {
          const Eigen::Array4f zero = Eigen::Array4f::Zero();
          entries_.push_back({zero, zero, zero, zero});
          joint = entry_joint_.insert(joint, skin.joint_idx[i]);
        }
        Entry& entry = entries_[static_cast<size_t>(joint - entry_joint_.begin())];
        const auto l = static_cast<Eigen::Index>(lane);
        entry.x[l] += skin.weight[i] * rest.x();
        entry.y[l] += skin.weight[i] * rest.y();
        entry.z[l] += skin.weight[i] * rest.z();
        entry.w[l] += skin.weight[i];
      }
    }
    chunks_.push_back({begin, static_cast<uint32_t>(entries_.size())});
  }
  for (const Face& face : body.rest.faces) {
    faces_.push_back({slot_of_vertex[face[0]], slot_of_vertex[face[1]], slot_of_vertex[face[2]]});
  }
}

void ProjectedSkin::set_matrices(std::span<const double> pose, Scratch& scratch) const {
  const auto num_joints = static_cast<size_t>(body_->skeleton.num_joints());
  scratch.world_from_joint.resize(num_joints);
  scratch.matrices.resize(12 * num_joints);
  body_->skeleton.forward_kinematics(pose, scratch.world_from_joint);

  Eigen::Matrix3d intrinsics = Eigen::Matrix3d::Identity();
  if (!camera_->has_distortion()) intrinsics << camera_->fx, 0, camera_->cx, 0, camera_->fy, camera_->cy, 0, 0, 1;
  const Eigen::Matrix3d rotation = intrinsics * camera_->cam_from_world.rotation;
  const Eigen::Vector3d translation = intrinsics * camera_->cam_from_world.translation;
  for (size_t j = 0; j < num_joints; ++j) {
    const Rigid3 world_from_rest = scratch.world_from_joint[j] * body_->joint_from_rest[j];
    Eigen::Matrix<double, 3, 4> matrix;
    matrix << rotation * world_from_rest.rotation, rotation * world_from_rest.translation + translation;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        scratch.matrices[12 * j + static_cast<size_t>(4 * row + column)] =
            Eigen::Array4f::Constant(static_cast<float>(matrix(row, column)));
      }
    }
  }
}

bool ProjectedSkin::project(std::span<const double> pose, Scratch& scratch) const {
  if (!std::ranges::all_of(pose, [](double value) { return std::isfinite(value); })) return false;
  set_matrices(pose, scratch);
  scratch.x.resize(chunks_.size());
  scratch.y.resize(chunks_.size());
  scratch.depth.resize(chunks_.size());
  Eigen::Array4f nearest = Eigen::Array4f::Constant(std::numeric_limits<float>::max());
  for (size_t c = 0; c < chunks_.size(); ++c) {
    Eigen::Array4f x = Eigen::Array4f::Zero(), y = x, z = x;
    for (uint32_t e = chunks_[c].begin; e < chunks_[c].end; ++e) {
      const Eigen::Array4f* m = &scratch.matrices[12 * entry_joint_[e]];
      const Entry& entry = entries_[e];
      x += m[0] * entry.x + m[1] * entry.y + (m[2] * entry.z + m[3] * entry.w);
      y += m[4] * entry.x + m[5] * entry.y + (m[6] * entry.z + m[7] * entry.w);
      z += m[8] * entry.x + m[9] * entry.y + (m[10] * entry.z + m[11] * entry.w);
    }
    nearest = nearest.min(z);
    const Eigen::Array4f inverse_depth = 1.0f / z;
    scratch.x[c] = x * inverse_depth;
    scratch.y[c] = y * inverse_depth;
    scratch.depth[c] = z;
  }
  if (camera_->has_distortion()) distort(scratch);

  scratch.some_unseen = !(nearest.minCoeff() >= static_cast<float>(PinholeCamera::kNear));
  if (scratch.some_unseen) return leave_out_unseen(scratch);
  Eigen::Array4f x0 = scratch.x[0], x1 = x0, y0 = scratch.y[0], y1 = y0;
  for (size_t c = 1; c < chunks_.size(); ++c) {
    x0 = x0.min(scratch.x[c]);
    x1 = x1.max(scratch.x[c]);
    y0 = y0.min(scratch.y[c]);
    y1 = y1.max(scratch.y[c]);
  }
  scratch.bounds = {x0.minCoeff(), y0.minCoeff(), x1.maxCoeff(), y1.maxCoeff()};
  return true;
}

void ProjectedSkin::distort(Scratch& scratch) const {
  std::array<float, 5> k;
  std::ranges::transform(camera_->distortion, k.begin(), [](double value) { return static_cast<float>(value); });
  const auto fx = static_cast<float>(camera_->fx), fy = static_cast<float>(camera_->fy);
  const auto cx = static_cast<float>(camera_->cx), cy = static_cast<float>(camera_->cy);
  for (size_t c = 0; c < chunks_.size(); ++c) {
    const Eigen::Array4f x = scratch.x[c], y = scratch.y[c];
    const Eigen::Array4f xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy;
    const Eigen::Array4f radial = 1.0f + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    scratch.x[c] = fx * (x * radial + 2.0f * k[2] * xy + k[3] * (r2 + 2.0f * xx)) + cx;
    scratch.y[c] = fy * (y * radial + k[2] * (r2 + 2.0f * yy) + 2.0f * k[3] * xy) + cy;
  }
}

bool ProjectedSkin::leave_out_unseen(Scratch& scratch) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PixelBounds bounds{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (size_t slot = 0; slot < num_slots(); ++slot) {
    const size_t chunk = slot / kLanes;
    const auto lane = static_cast<Eigen::Index>(slot % kLanes);
    float& x = scratch.x[chunk][lane];
    const float y = scratch.y[chunk][lane];
    if (!(scratch.depth[chunk][lane] >= static_cast<float>(PinholeCamera::kNear))) {
      x = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    bounds = {std::min<double>(bounds.x0, x), std::min<double>(bounds.y0, y), std::max<double>(bounds.x1, x),
              std::max<double>(bounds.y1, y)};
  }
  scratch.bounds = bounds;
  return bounds.x0 <= bounds.x1;
}

void ProjectedSkin::copy_pixels(const Scratch& scratch, std::span<Eigen::Vector2f> pixels) const {
  check(pixels.size() == num_slots(), "ProjectedSkin: {} slots, room for {}", num_slots(), pixels.size());
  Eigen::Vector2f* pixel = pixels.data();
  for (size_t c = 0; c < chunks_.size(); ++c) {
    for (Eigen::Index lane = 0; lane < 4; ++lane) *pixel++ = {scratch.x[c][lane], scratch.y[c][lane]};
  }
}

void ProjectedSkin::round(const Window& window, Scratch& scratch) const {
  const GridAxis x_axis(window.x0, window.scale_x), y_axis(window.y0, window.scale_y);
  scratch.points.resize(num_slots());
  GridPoint* point = scratch.points.data();
  for (size_t c = 0; c < chunks_.size(); ++c) {
    const Int4 x = x_axis.round(scratch.x[c]), y = y_axis.round(scratch.y[c]);
    for (int lane = 0; lane < 4; ++lane) *point++ = {x[lane], y[lane]};
  }
  if (!scratch.some_unseen) return;
  for (size_t slot = 0; slot < num_slots(); ++slot) {
    if (std::isnan(scratch.x[slot / kLanes][static_cast<Eigen::Index>(slot % kLanes)])) {
      scratch.points[slot] = kUnseenPoint;
    }
  }
}

}  // namespace silpose
