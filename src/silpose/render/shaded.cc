#include "silpose/render/shaded.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/render/silhouette.h"
#include "silpose/render/triangle_fill.h"

namespace silpose {
namespace {

constexpr int kSamples = 2;  // a pixel, along each axis

// A mesh as a camera sees it on a raster.
struct SampledMesh {
  SampledMesh(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
              std::span<const Face> mesh_faces, const Window& window)
      : width(window.width), height(window.height), faces(mesh_faces.begin(), mesh_faces.end()) {
    project_mesh(camera, vertices_in_world, mesh_faces, projected);
    faces.insert(faces.end(), projected.cut_faces.begin(), projected.cut_faces.end());
    points.resize(projected.pixels.size());
    round_to_grid(projected.pixels, window, points);
    for (const Eigen::Vector3f& vertex : vertices_in_world) {
      inverse_depth.push_back(1 / (camera.cam_from_world * vertex.cast<double>()).z());
    }
    for (const auto& vertex : projected.cut_vertices) inverse_depth.push_back(1 / vertex.depth);
  }

  // Calls visit(x, y, inverse depth, perspective-correct weights of the corners) for the samples of a face.
  template <class Visit>
  void for_each_sample(const Face& face, Visit&& visit) const {
    check(std::max({face[0], face[1], face[2]}) < points.size(), "a face names a vertex of {}", points.size());
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (a.unseen() || b.unseen() || c.unseen()) return;
    fill_triangle(a, b, c, width, height, [&](int x, int y, int64_t wa, int64_t wb, int64_t wc) {
      Eigen::Vector3d weights(static_cast<double>(wa) * inverse_depth[face[0]],
                              static_cast<double>(wb) * inverse_depth[face[1]],
                              static_cast<double>(wc) * inverse_depth[face[2]]);
      const double sum = weights.sum();
      visit(x, y, sum / static_cast<double>(wa + wb + wc), Eigen::Vector3d(weights / sum));
    });
  }

  int width, height;
  std::vector<Face> faces;  // the mesh's, then the cut ones
  ProjectedMesh projected;
  std::vector<GridPoint> points;
  std::vector<double> inverse_depth;
};

Window sampled_image(const PinholeCamera& camera) {
  return {
      .scale_x = kSamples, .scale_y = kSamples, .width = kSamples * camera.width, .height = kSamples * camera.height};
}

std::vector<Eigen::Vector3f> vertex_normals(std::span<const Eigen::Vector3f> vertices, std::span<const Face> faces) {
  std::vector<Eigen::Vector3f> normals(vertices.size(), Eigen::Vector3f::Zero());
  for (const Face& face : faces) {
    const Eigen::Vector3f& a = vertices[face[0]];
    const Eigen::Vector3f normal = (vertices[face[1]] - a).cross(vertices[face[2]] - a);  // longer for larger faces
    for (const uint32_t vertex : face) normals[vertex] += normal;
  }
  for (Eigen::Vector3f& normal : normals) normal.normalize();
  return normals;
}

// Blends `colour` (0 to 255) over a pixel.
void blend(std::span<uint8_t> pixel, const Eigen::Vector3f& colour, float opacity) {
  for (int c = 0; c < 3; ++c) {
    uint8_t& value = pixel[static_cast<size_t>(c)];
    const float blended = static_cast<float>(value) * (1 - opacity) + colour[c] * opacity;
    value = static_cast<uint8_t>(std::clamp(blended + 0.5f, 0.0f, 255.0f));
  }
}

void draw_shadow(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices, std::span<const Face> faces,
                 const Lighting& lighting, ByteImage& image) {
  const Eigen::Vector3f slope = (lighting.to_light / lighting.to_light.y()).cast<float>();
  std::vector<Eigen::Vector3f> on_floor;
  on_floor.reserve(vertices.size());
  for (const Eigen::Vector3f& vertex : vertices) on_floor.emplace_back(vertex - slope * vertex.y());
  const Window window = sampled_image(camera);
  const SampledMesh mesh(camera, on_floor, faces, window);
  Mask mask;
  draw_silhouette_reference(mesh.projected.pixels, mesh.faces, window, mask);
  for (int y = 0; y < image.height(); ++y) {
    const auto row = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      int covered = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        covered += mask.get(kSamples * x + k % kSamples, kSamples * y + k / kSamples);
      }
      const auto opacity = static_cast<float>(lighting.shadow * covered / (kSamples * kSamples));
      if (covered > 0) blend(row.subspan(3 * static_cast<size_t>(x), 3), Eigen::Vector3f::Zero(), opacity);
    }
  }
}

const Eigen::Vector3f kSkin(0.52f, 0.62f, 0.82f), kShirt(0.62f, 0.34f, 0.24f), kTrousers(0.30f, 0.27f, 0.25f),
    kShoes(0.14f, 0.14f, 0.16f), kNoClothing(0.6f, 0.6f, 0.6f);

// A joint of the human and what the part it moves wears.
Eigen::Vector3f clothing_of(std::string_view joint) {
  const auto ends = [&](std::string_view suffix) { return joint.ends_with(suffix); };
  if (joint == "head" || ends("forearm") || ends("hand")) return kSkin;
  if (joint == "abdomen" || joint == "thorax" || ends("shoulder") || ends("upper_arm")) return kShirt;
  if (joint == "root" || ends("hip") || ends("thigh") || ends("shin")) return kTrousers;
  if (ends("foot")) return kShoes;
  return kNoClothing;
}

// The colour of each vertex of a sampled mesh in its light, cut ones included.
std::vector<Eigen::Vector3f> vertex_shades(const SampledMesh& mesh, std::span<const Eigen::Vector3f> vertices_in_world,
                                           std::span<const Face> faces, std::span<const Eigen::Vector3f> colours,
                                           const Lighting& lighting) {
  const Eigen::Vector3f to_light = lighting.to_light.normalized().cast<float>();
  const auto ambient = static_cast<float>(lighting.ambient);
  const std::vector<Eigen::Vector3f> normals = vertex_normals(vertices_in_world, faces);
  std::vector<Eigen::Vector3f> shades(normals.size());
  for (size_t i = 0; i < shades.size(); ++i) {
    const float towards = std::max(0.0f, normals[i].dot(to_light));
    shades[i] = 255 * (ambient + (1 - ambient) * towards) * colours[i];
  }
  for (const auto& [face, weights, depth] : mesh.projected.cut_vertices) {
    Eigen::Vector3f shade = Eigen::Vector3f::Zero();
    for (int k = 0; k < 3; ++k) shade += static_cast<float>(weights[k]) * shades[faces[face][static_cast<size_t>(k)]];
    shades.push_back(shade);
  }
  return shades;
}

// Blends rows [y_begin, y_end) of samples into the image: each pixel by the share of its samples that are covered,
// which are those of a nearness above 0.
void blend_samples(const Image<float>& nearness, const Image<float>& shade, int y_begin, int y_end, ByteImage& image) {
  for (int y = y_begin; y < y_end; ++y) {
    const auto row = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      int covered = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int sample_x = kSamples * x + k % kSamples, sample_y = kSamples * y + k / kSamples;
        if (nearness.at(sample_x, sample_y) == 0) continue;
        sum += Eigen::Map<const Eigen::Vector3f>(&shade.at(sample_x, sample_y));
        ++covered;
      }
      if (covered == 0) continue;
      const auto share = static_cast<float>(covered);
      blend(row.subspan(3 * static_cast<size_t>(x), 3), sum / share, share / (kSamples * kSamples));
    }
  }
}

}  // namespace

Image<float> draw_depth(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                        std::span<const Face> faces) {
  return draw_depth(camera, vertices_in_world, faces, {.width = camera.width, .height = camera.height});
}

Image<float> draw_depth(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                        std::span<const Face> faces, const Window& window) {
  Image<float> depth(window.width, window.height);
  const SampledMesh mesh(camera, vertices_in_world, faces, window);
  for (const Face& face : mesh.faces) {
    mesh.for_each_sample(face, [&](int x, int y, double inverse_depth, const Eigen::Vector3d&) {
      float& nearest = depth.at(x, y);
      const auto distance = static_cast<float>(1 / inverse_depth);
      if (nearest == 0 || distance < nearest) nearest = distance;
    });
  }
  return depth;
}

void draw_shaded(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                 std::span<const Face> faces, std::span<const Eigen::Vector3f> colours, const Lighting& lighting,
                 ByteImage& image) {
  check(image.width() == camera.width && image.height() == camera.height && image.channels() == 3,
        "draw_shaded: image of {}x{}x{} for a camera of {}x{}", image.width(), image.height(), image.channels(),
        camera.width, camera.height);
  check(colours.size() == vertices_in_world.size(), "draw_shaded: {} colours for {} vertices", colours.size(),
        vertices_in_world.size());
  if (lighting.shadow > 0 && lighting.to_light.y() > 0) {
    draw_shadow(camera, vertices_in_world, faces, lighting, image);
  }

  const SampledMesh mesh(camera, vertices_in_world, faces, sampled_image(camera));
  const auto bounds = pixel_bounds(mesh.projected.pixels);
  if (!bounds) return;
  const std::vector<Eigen::Vector3f> shades = vertex_shades(mesh, vertices_in_world, faces, colours, lighting);
  Image<float> nearness(mesh.width, mesh.height);  // inverse depth; 0 where there is nothing
  Image<float> shade(mesh.width, mesh.height, 3);
  for (const Face& face : mesh.faces) {
    mesh.for_each_sample(face, [&](int x, int y, double inverse_depth, const Eigen::Vector3d& weights) {
      float& nearest = nearness.at(x, y);
      if (static_cast<float>(inverse_depth) <= nearest) return;
      nearest = static_cast<float>(inverse_depth);
      const Eigen::Vector3f w = weights.cast<float>();
      Eigen::Map<Eigen::Vector3f>(&shade.at(x, y)) =
          w[0] * shades[face[0]] + w[1] * shades[face[1]] + w[2] * shades[face[2]];
    });
  }

  const int y_begin = std::max(0, static_cast<int>(std::min(bounds->y0, 1e6)) - 1);
  const int y_end = static_cast<int>(std::clamp(bounds->y1 + 2, 0.0, static_cast<double>(image.height())));
  blend_samples(nearness, shade, y_begin, y_end, image);
}

std::vector<Eigen::Vector3f> clothing_colours(const BodyModel& body) {
  const auto joints = body.skeleton.joints();
  const auto head = body.skeleton.find_joint("head");
  std::vector<Eigen::Vector3f> colours(body.rest.vertices.size(), Eigen::Vector3f::Zero());
  for (size_t v = 0; v < colours.size(); ++v) {
    float head_weight = 0;
    float largest = 0;
    for (uint32_t i = body.skin.row_start[v]; i < body.skin.row_start[v + 1]; ++i) {
      const float weight = body.skin.weight[i];
      if (head && body.skin.joint_idx[i] == *head) head_weight = weight;
      if (weight <= largest) continue;
      largest = weight;
      colours[v] = clothing_of(joints[body.skin.joint_idx[i]].name);
    }
    if (head_weight < 0.9f) continue;
    // Hair: the top and the back of the head, by where it lies above and behind the joint.
    const Eigen::Vector3d x_in_head =
        body.joint_from_rest[static_cast<size_t>(*head)] * body.rest.vertices[v].cast<double>();
    const double size = body.height_m > 0 ? body.height_m / 1.7 : 1;
    if (x_in_head.y() > (0.12 + 0.7 * std::max(0.0, x_in_head.z())) * size || x_in_head.z() < -0.03 * size) {
      colours[v] = {0.12f, 0.16f, 0.22f};
    }
  }
  return colours;
}

}  // namespace silpose
