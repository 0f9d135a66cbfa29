#include "silhouette_scene.h"

#include <filesystem>
#include <utility>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/random_pose.h"

namespace silpose::bench {
namespace {

std::vector<Eigen::Vector2f> pixels_of(const SilhouetteScene& scene, std::span<const double> pose) {
  const auto vertices = skin_vertices(*scene.body, pose);
  std::vector<Eigen::Vector2f> pixels(vertices.size());
  project_vertices(scene.camera, vertices, pixels);
  return pixels;
}

}  // namespace

std::shared_ptr<const BodyModel> human() {
  const auto path = std::filesystem::path(SILPOSE_DATA_DIR) / "human.body";
  return std::make_shared<BodyModel>(load_body(path).value());
}

SilhouetteScene standing_scene(std::shared_ptr<const BodyModel> body, size_t num_poses, int size) {
  constexpr double kExtent = 320;  // image pixels
  SilhouetteScene scene{.body = std::move(body), .camera = default_camera(640, 480)};
  scene.window = {
      .x0 = 160, .y0 = 130, .scale_x = size / kExtent, .scale_y = size / kExtent, .width = size, .height = size};
  scene.num_poses = num_poses;
  scene.num_dofs = static_cast<size_t>(scene.body->skeleton.num_dofs());
  const std::vector<double> standing = standing_pose(*scene.body);
  Rng rng(1);
  for (size_t n = 0; n <= num_poses; ++n) {
    const auto pose = random_pose(scene.body->skeleton, standing, rng, {.part = 1.0 / 3, .shift_m = 0.15});
    scene.poses.insert(scene.poses.end(), pose.begin(), pose.end());
  }
  scene.observed = plain_silhouette(scene, scene.pose(num_poses));
  return scene;
}

Mask plain_silhouette(const SilhouetteScene& scene, std::span<const double> pose) {
  Mask mask;
  draw_silhouette_reference(pixels_of(scene, pose), scene.body->rest.faces, scene.window, mask);
  return mask;
}

ByteImage plain_coverage(const SilhouetteScene& scene, std::span<const double> pose) {
  return draw_coverage_reference(pixels_of(scene, pose), scene.body->rest.faces, scene.window);
}

std::vector<int64_t> plain_distances(const SilhouetteScene& scene, size_t first, size_t count, const Mask& observed) {
  std::vector<int64_t> distances(count);
  parallel_for(count, 8, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      distances[n] = xor_count(plain_silhouette(scene, scene.pose(first + n)), observed);
    }
  });
  return distances;
}

std::vector<int64_t> our_distances(const SilhouetteScene& scene, const BatchRenderer& renderer, size_t first,
                                   size_t count, const Mask& observed) {
  std::vector<OutlineRenderer::Counts> counts(count);
  renderer.counts({scene.pose(first).data(), count, scene.num_dofs, scene.num_dofs}, scene.window, observed, counts);
  const int64_t observed_count = observed.count();
  std::vector<int64_t> distances(count);
  for (size_t n = 0; n < count; ++n) distances[n] = counts[n].model + observed_count - 2 * counts[n].both;
  return distances;
}

void clip_from_rest(const SilhouetteScene& scene, std::span<const double> pose, std::span<ClipFromRest> matrices) {
  const PinholeCamera& camera = scene.camera;
  const Window& window = scene.window;
  // Twice raster pixels over the window's size, minus one.
  const double sx = 2 * window.scale_x / window.width, sy = 2 * window.scale_y / window.height;
  Eigen::Matrix3d intrinsics;
  intrinsics << sx * camera.fx, 0, sx * (camera.cx - window.x0) - 1,  //
      0, sy * camera.fy, sy * (camera.cy - window.y0) - 1,            //
      0, 0, 1;
  const auto world_from_joint = scene.body->skeleton.forward_kinematics(pose);
  for (size_t j = 0; j < matrices.size(); ++j) {
    const Rigid3 cam_from_rest = camera.cam_from_world * world_from_joint[j] * scene.body->joint_from_rest[j];
    Eigen::Matrix<double, 3, 4> matrix;
    matrix << cam_from_rest.rotation, cam_from_rest.translation;
    matrices[j] = (intrinsics * matrix).cast<float>();
  }
}

}  // namespace silpose::bench
