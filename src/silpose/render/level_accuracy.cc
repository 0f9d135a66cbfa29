#include "silpose/render/level_accuracy.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/random_pose.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

// All around at 2.5 statures, in turns from half and from one and a half of the body's height.
std::vector<PinholeCamera> cameras_around(double height_m, int num_views) {
  std::vector<PinholeCamera> cameras;
  for (int c = 0; c < num_views; ++c) {
    const double angle = 2 * kPi * c / num_views, distance = 2.5 * height_m;
    const Eigen::Vector3d camera_centre(distance * std::sin(angle), (c % 2 == 0 ? 0.5 : 1.5) * height_m,
                                        distance * std::cos(angle));
    cameras.push_back(look_at_camera(640, 480, 640, camera_centre, {0, 0.5 * height_m, 0}));
  }
  return cameras;
}

}  // namespace

LevelAccuracy level_accuracy(const BodyModel& body, const BodyLevel& level, const AccuracyOptions& options) {
  check(options.num_poses >= 1 && options.num_views >= 1, "level_accuracy: {} poses, {} views", options.num_poses,
        options.num_views);
  const EdgeTopology whole(body.rest.faces), coarse(level.faces);
  const std::vector<double> standing = standing_pose(body);
  const std::vector<PinholeCamera> cameras = cameras_around(body.height_m, options.num_views);
  const auto num_poses = static_cast<size_t>(options.num_poses);
  std::vector<double> iou(num_poses * cameras.size());
  parallel_for(num_poses, 4, [&](size_t begin, size_t end) {
    OutlineRenderer draw_whole(whole), draw_coarse(coarse);
    Mask whole_mask, coarse_mask;
    std::vector<Eigen::Vector2f> pixels(body.rest.vertices.size()), coarse_pixels(level.vertices.size());
    for (size_t n = begin; n < end; ++n) {
      Rng rng(options.seed, n);
      const auto vertices = skin_vertices(body, random_pose(body.skeleton, standing, rng));
      for (size_t c = 0; c < cameras.size(); ++c) {
        project_vertices(cameras[c], vertices, pixels);
        for (size_t v = 0; v < level.vertices.size(); ++v) coarse_pixels[v] = pixels[level.vertices[v]];
        const auto bounds = pixel_bounds(pixels);
        check(bounds.has_value(), "level_accuracy: the body is not before the cameras around it");
        const Window window = window_of(*bounds, options.size, options.size);
        draw_whole.draw(pixels, window, whole_mask);
        draw_coarse.draw(coarse_pixels, window, coarse_mask);
        iou[n * cameras.size() + c] = intersection_over_union(whole_mask, coarse_mask);
      }
    }
  });
  LevelAccuracy accuracy;
  for (const double value : iou) {
    accuracy.mean_iou += value / static_cast<double>(iou.size());
    accuracy.worst_iou = std::min(accuracy.worst_iou, value);
  }
  return accuracy;
}

}  // namespace silpose
