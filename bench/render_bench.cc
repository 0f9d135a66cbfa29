#include "render_bench.h"

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "agreement.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/body_model.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose::bench {
namespace {

constexpr int kSize = 128;

// Standing poses that use a third of every angle's range.
std::vector<double> random_poses(const BodyModel& body, size_t count) {
  Rng rng(1);
  const std::vector<double> standing = standing_pose(body);
  const auto dofs = body.skeleton.dofs();
  std::vector<double> poses;
  for (size_t n = 0; n < count; ++n) {
    for (size_t d = 0; d < dofs.size(); ++d) {
      const double range = dofs[d].is_translation ? 0.3 : (dofs[d].upper - dofs[d].lower) / 3;
      poses.push_back(standing[d] + range * rng.uniform(-0.5, 0.5));
    }
  }
  return poses;
}

Figure likelihood(std::shared_ptr<const BodyModel> body, size_t num_poses) {
  const PinholeCamera camera = default_camera(640, 480);
  const Window window{
      .x0 = 160, .y0 = 130, .scale_x = kSize / 320.0, .scale_y = kSize / 320.0, .width = kSize, .height = kSize};
  const auto num_dofs = static_cast<size_t>(body->skeleton.num_dofs());
  const std::vector<double> poses = random_poses(*body, num_poses + 1);
  const auto pose = [&](size_t n) { return std::span(poses).subspan(n * num_dofs, num_dofs); };
  const auto draw = [&](size_t n, Mask& mask) {
    const auto vertices = skin_vertices(*body, pose(n));
    std::vector<Eigen::Vector2f> pixels(vertices.size());
    project_vertices(camera, vertices, pixels);
    draw_silhouette_reference(pixels, body->rest.faces, window, mask);
  };
  Mask observed;
  draw(num_poses, observed);
  const int64_t observed_count = observed.count();

  const BatchRenderer renderer(body, camera);
  std::vector<OutlineRenderer::Counts> counts(num_poses);
  std::vector<int64_t> distances(num_poses), reference_distances(num_poses);
  const auto ours = [&] {
    renderer.counts({poses.data(), num_poses, num_dofs, num_dofs}, window, observed, counts);
    for (size_t n = 0; n < num_poses; ++n) distances[n] = counts[n].model + observed_count - 2 * counts[n].both;
  };
  // The reference takes its time: it gets an eighth of the poses, its rate is scaled.
  constexpr size_t kShare = 8;
  const auto reference = [&](size_t count) {
    parallel_for(count, 8, [&](size_t begin, size_t end) {
      Mask mask;
      for (size_t n = begin; n < end; ++n) {
        draw(n, mask);
        reference_distances[n] = xor_count(mask, observed);
      }
    });
  };
  ours();
  reference(num_poses);
  int64_t total = 0;
  for (size_t n = 0; n < num_poses; ++n) {
    verify(std::abs(distances[n] - reference_distances[n]) <= 4, "distance of pose " + std::to_string(n));
    total += reference_distances[n];
  }
  verify(total > static_cast<int64_t>(num_poses) * 100, "distances are too small to be of random poses");

  Figure figure = measure({.unit = "poses/s",
                           .peer = "plain renderer, every triangle filled",
                           .value_at_one_second = static_cast<double>(num_poses)},
                          ours, [&] { reference(num_poses / kShare); });
  figure.peer_value /= kShare;
  figure.ratio *= kShare;
  return figure;
}

std::shared_ptr<const BodyModel> human() {
  const auto path = std::filesystem::path(SILPOSE_DATA_DIR) / "human.body";
  return std::make_shared<BodyModel>(load_body(path).value());
}

Figure xor_us(int size) {
  cv::RNG noise(1);
  cv::Mat a(size, size, CV_8U), b(size, size, CV_8U), difference(size, size, CV_8U);
  noise.fill(a, cv::RNG::UNIFORM, 0, 2);
  noise.fill(b, cv::RNG::UNIFORM, 0, 2);
  Mask mask_a(size, size), mask_b(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      mask_a.set(x, y, a.at<uint8_t>(y, x) != 0);
      mask_b.set(x, y, b.at<uint8_t>(y, x) != 0);
    }
  }
  cv::bitwise_xor(a, b, difference);
  verify(xor_count(mask_a, mask_b) == cv::countNonZero(difference), "XOR count");

  constexpr int kRepeats = 2000;
  return measure(
      {.unit = "us",
       .peer = "OpenCV bitwise_xor and countNonZero on bytes",
       .higher_is_better = false,
       .value_at_one_second = 1e6 / kRepeats},
      [&] {
        for (int i = 0; i < kRepeats; ++i) keep(xor_count(mask_a, mask_b));
      },
      [&] {
        for (int i = 0; i < kRepeats; ++i) {
          cv::bitwise_xor(a, b, difference);
          keep(cv::countNonZero(difference));
        }
      });
}

}  // namespace

Figure likelihood_full() {
  const Agreement agreement = measure_agreement(human(), 1000);
  verify(agreement.from_pixels == 0, "pixels differ from the same projected vertices");
  verify(100'000 * agreement.from_poses <= agreement.pixels,
         "more than a pixel in 100,000 differs from the same poses");
  return likelihood(human(), 1000);
}
Figure likelihood_lod() { return likelihood(std::make_shared<BodyModel>(level_of_detail(*human(), 2000)), 4000); }
Figure xor_128_us() { return xor_us(128); }
Figure xor_256_us() { return xor_us(256); }

}  // namespace silpose::bench
