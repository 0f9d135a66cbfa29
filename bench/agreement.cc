#include "agreement.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/random_pose.h"
#include "silpose/geometry/rigid3.h"
#include "silpose/render/silhouette.h"

namespace silpose::bench {
namespace {

constexpr int kSize = 128, kCameras = 4;

struct Views {
  std::vector<PinholeCamera> cameras;
  Window window{
      .x0 = 140, .y0 = 60, .scale_x = kSize / 360.0, .scale_y = kSize / 360.0, .width = kSize, .height = kSize};
  Views() {
    for (int c = 0; c < kCameras; ++c) {
      const double angle = 0.3 + 2 * kPi * c / kCameras;
      cameras.push_back(
          look_at_camera(640, 480, 700, {4 * std::sin(angle), 0.6 + 0.5 * c, 4 * std::cos(angle)}, {0, 0.9, 0}));
    }
  }
};

}  // namespace

Agreement measure_agreement(const std::shared_ptr<const BodyModel>& body, size_t num_poses) {
  const Views views;
  const std::vector<double> standing = standing_pose(*body);
  std::vector<std::vector<double>> poses;
  for (size_t n = 0; n < num_poses; ++n) {
    Rng rng(3, n);
    poses.push_back(random_pose(body->skeleton, standing, rng));
  }
  const EdgeTopology topology(body->rest.faces);
  std::vector<Mask> references(num_poses * kCameras);
  // draw(renderer, pixels, index) for every pose and camera.
  const auto for_all = [&](const auto& draw) {
    parallel_for(num_poses, 4, [&](size_t begin, size_t end) {
      OutlineRenderer renderer(topology);
      std::vector<Eigen::Vector2f> pixels(body->rest.vertices.size());
      for (size_t n = begin; n < end; ++n) {
        const auto vertices = skin_vertices(*body, poses[n]);
        for (size_t c = 0; c < kCameras; ++c) {
          project_vertices(views.cameras[c], vertices, pixels);
          draw(renderer, pixels, n * kCameras + c);
        }
      }
    });
  };
  for_all([&](OutlineRenderer&, const auto& pixels, size_t i) {
    draw_silhouette_reference(pixels, body->rest.faces, views.window, references[i]);
  });
  Agreement agreement;
  for (const Mask& reference : references) agreement.pixels += reference.count();

  std::vector<int64_t> differing(references.size());
  const auto sum = [&] {
    int64_t all = 0;
    for (const int64_t value : differing) all += value;
    return all;
  };
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for_all([&](OutlineRenderer& renderer, const auto& pixels, size_t i) {
      Mask mask;
      renderer.draw(pixels, views.window, mask);
      differing[i] = xor_count(mask, references[i]);
    });
    agreement.from_pixels = std::max<long long>(agreement.from_pixels, sum());
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }

  for (size_t c = 0; c < kCameras; ++c) {
    const BatchRenderer renderer(body, views.cameras[c]);
    for (size_t n = 0; n < num_poses; ++n) {
      const Mask& reference = references[n * kCameras + c];
      OutlineRenderer::Counts counts;
      renderer.counts({poses[n].data(), 1, poses[n].size(), poses[n].size()}, views.window, reference, {&counts, 1});
      differing[n * kCameras + c] = counts.model + reference.count() - 2 * counts.both;
    }
  }
  agreement.from_poses = sum();
  return agreement;
}

}  // namespace silpose::bench
