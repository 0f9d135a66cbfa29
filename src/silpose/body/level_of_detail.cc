#include <meshoptimizer.h>

#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/body/body_model.h"

namespace silpose {
namespace {

std::vector<Face> faces_of(const std::vector<uint32_t>& indices) {
  std::vector<Face> faces;
  for (size_t i = 0; i < indices.size(); i += 3) faces.push_back({indices[i], indices[i + 1], indices[i + 2]});
  return faces;
}

}  // namespace

BodyLevel simplify(const BodyModel& body, int num_vertices) {
  check(num_vertices >= 100, "level of detail: {} vertices are too few", num_vertices);
  const std::vector<Eigen::Vector3f>& x = body.rest.vertices;
  std::vector<uint32_t> indices;
  for (const Face& face : body.rest.faces) indices.insert(indices.end(), face.begin(), face.end());
  const bool closed = is_closed(body.rest.faces);
  std::vector<uint32_t> kept = indices;
  // A closed surface of V vertices has 2 (V - 2) faces. Where a collapse has pinched the surface, a little more detail
  // usually has not; the whole mesh is the last resort.
  size_t num_faces = 2 * static_cast<size_t>(num_vertices - 2);
  for (; 3 * num_faces < indices.size(); num_faces += 2 + num_faces / 100) {
    kept.resize(indices.size());
    kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), x[0].data(), x.size(),
                                 sizeof(Eigen::Vector3f), 3 * num_faces, 1.0f, 0, nullptr));
    if (!closed || is_closed(faces_of(kept))) break;
    kept = indices;
  }
  BodyLevel level{.asked_vertices = num_vertices, .vertices = {}, .faces = {}};
  constexpr uint32_t kUnused = ~0u;
  std::vector<uint32_t> new_from_old(x.size(), kUnused);
  for (const uint32_t v : kept) new_from_old[v] = 0;
  for (uint32_t v = 0; v < x.size(); ++v) {
    if (new_from_old[v] == kUnused) continue;
    new_from_old[v] = static_cast<uint32_t>(level.vertices.size());
    level.vertices.push_back(v);
  }
  for (uint32_t& v : kept) v = new_from_old[v];
  level.faces = faces_of(kept);
  return level;
}

BodyModel body_of_level(const BodyModel& body, const BodyLevel& level) {
  BodyModel out = body;
  out.levels.clear();
  out.rest = {.vertices = {}, .faces = level.faces};
  out.skin = {.row_start = {0}, .joint_idx = {}, .weight = {}};
  for (const uint32_t v : level.vertices) {
    out.rest.vertices.push_back(body.rest.vertices[v]);
    for (uint32_t i = body.skin.row_start[v]; i < body.skin.row_start[v + 1]; ++i) {
      out.skin.joint_idx.push_back(body.skin.joint_idx[i]);
      out.skin.weight.push_back(body.skin.weight[i]);
    }
    out.skin.row_start.push_back(static_cast<uint32_t>(out.skin.weight.size()));
  }
  return out;
}

BodyModel level_of_detail(const BodyModel& body, int num_vertices) {
  const auto own = std::ranges::find(body.levels, num_vertices, &BodyLevel::asked_vertices);
  return body_of_level(body, own != body.levels.end() ? *own : simplify(body, num_vertices));
}

const BodyLevel* coarsest_level(const BodyModel& body, double mean_iou) {
  const BodyLevel* coarsest = nullptr;
  for (const BodyLevel& level : body.levels) {
    if (level.mean_iou < mean_iou) continue;
    if (coarsest == nullptr || level.vertices.size() < coarsest->vertices.size()) coarsest = &level;
  }
  return coarsest;
}

std::shared_ptr<const BodyModel> level_of_detail(const std::shared_ptr<const BodyModel>& body, int num_vertices) {
  return num_vertices == 0 ? body : std::make_shared<const BodyModel>(level_of_detail(*body, num_vertices));
}

}  // namespace silpose
