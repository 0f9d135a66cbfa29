#include "silpose/render/depth_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"
#include "silpose/render/shaded.h"
#include "silpose/shape/distance.h"

namespace silpose {
namespace {

constexpr double kMissing = 0.5;  // metres

class DepthRendererTest : public testing::Test {
 protected:
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  size_t num_dofs_ = static_cast<size_t>(body_->skeleton.num_dofs());
  std::vector<double> poses_ = random_poses(20);

  std::vector<double> random_poses(size_t count) const {
    Rng rng(1);
    std::vector<double> poses;
    for (size_t i = 0; i < count * num_dofs_; ++i) poses.push_back(rng.uniform(-0.4, 0.4));
    return poses;
  }
  BatchView view(const std::vector<double>& poses) const {
    return {poses.data(), poses.size() / num_dofs_, num_dofs_, num_dofs_};
  }
  Image<float> reference(const PinholeCamera& camera, const Window& window, size_t n) const {
    return draw_depth(camera, skin_vertices(*body_, std::span(poses_).subspan(n * num_dofs_, num_dofs_)),
                      body_->rest.faces, window);
  }

  // Rounding in single precision may move a vertex by one grid step: a pixel of the outline here and there.
  void expect_reference(const PinholeCamera& camera, const Window& window, size_t num_poses) const {
    const DepthRenderer renderer(body_, camera);
    const std::vector<double> poses(poses_.begin(),
                                    poses_.begin() + static_cast<std::ptrdiff_t>(num_poses * num_dofs_));
    const size_t size = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
    std::vector<float> images(num_poses * size);
    renderer.images(view(poses), window, images);
    const Image<float> observed = reference(camera, window, 0);
    std::vector<double> distances(num_poses);
    renderer.distances(view(poses), window, observed, kMissing, distances);
    int64_t seen = 0, differing = 0;
    for (size_t n = 0; n < num_poses; ++n) {
      const Image<float> plain = reference(camera, window, n);
      for (size_t i = 0; i < size; ++i) {
        const float ours = images[n * size + i], theirs = plain.pixels()[i];
        seen += theirs != 0;
        differing += (ours == 0) != (theirs == 0) || std::abs(ours - theirs) > 1e-3f;
      }
      const double expected = depth_ssd(plain, observed, kMissing);
      EXPECT_NEAR(distances[n], expected, 1e-3 * expected + 2 * kMissing * kMissing) << n;
    }
    EXPECT_GT(seen, static_cast<int64_t>(num_poses) * 200);
    EXPECT_LE(differing, 1 + seen / 2000);
  }
};

TEST_F(DepthRendererTest, DrawsWhatTheReferenceDrawsForSeveralCameras) {
  for (const double angle : {0.0, 1.3, 2.9, 4.4}) {
    const PinholeCamera camera =
        look_at_camera(160, 120, 150, {3 * std::sin(angle), 1 + 0.3 * angle, 3 * std::cos(angle)}, {0, 0.6, 0});
    expect_reference(camera, {.width = 160, .height = 120}, 20);
    expect_reference(camera, {.x0 = 40, .y0 = 10, .scale_x = 0.7, .scale_y = 0.9, .width = 61, .height = 77}, 20);
  }
}

TEST_F(DepthRendererTest, DrawsThroughADistortingLens) {
  PinholeCamera camera = look_at_camera(160, 120, 150, {0.5, 1.2, 3}, {0, 0.6, 0});
  camera.distortion = {-0.3, 0.1, 0.004, -0.003, 0.02};
  expect_reference(camera, {.width = 160, .height = 120}, 20);
}

TEST_F(DepthRendererTest, DrawsWindowsOf1024) {
  const PinholeCamera camera = look_at_camera(640, 480, 600, {0.5, 1.2, 3}, {0, 0.6, 0});
  expect_reference(camera, {.x0 = 120, .y0 = 40, .scale_x = 2.56, .scale_y = 2.56, .width = 1024, .height = 1024}, 2);
}

TEST_F(DepthRendererTest, CutsWhatCrossesTheNearPlane) {
  expect_reference(look_at_camera(96, 72, 60, {0, 0.9, 0.35}, {0, 0.5, 0}), {.width = 96, .height = 72}, 20);
}

TEST_F(DepthRendererTest, ThreadsDoNotChangeDistancesAndNothingIsLeftOver) {
  const PinholeCamera camera = look_at_camera(160, 120, 150, {0.5, 1.2, 3}, {0, 0.6, 0});
  const DepthRenderer renderer(body_, camera);
  const Window window{.width = 160, .height = 120};
  const Image<float> observed = reference(camera, window, 3);
  std::vector<double> one(20), many(20), again(20);
  {
    const ThreadLimit limit(1);
    renderer.distances(view(poses_), window, observed, kMissing, one);
    renderer.distances(view(poses_), window, observed, kMissing, again);
  }
  renderer.distances(view(poses_), window, observed, kMissing, many);
  EXPECT_EQ(one, many);
  EXPECT_EQ(one, again);
  EXPECT_EQ(std::ranges::min_element(one) - one.begin(), 3);
}

TEST_F(DepthRendererTest, UnseenAndBrokenPosesShowNothing) {
  const PinholeCamera camera = default_camera(160, 120, 3.0);
  std::vector<double> poses(3 * num_dofs_, 0.0);
  poses[2] = 20;  // behind the camera
  poses[num_dofs_] = std::numeric_limits<double>::quiet_NaN();
  poses[2 * num_dofs_] = 50;  // outside the image
  const Window window{.width = 160, .height = 120};
  const Image<float> observed = reference(look_at_camera(160, 120, 150, {0, 1, 3}, {0, 0.6, 0}), window, 0);
  const auto seen = std::ranges::count_if(observed.pixels(), [](float depth) { return depth != 0; });
  std::vector<double> distances(3);
  const DepthRenderer renderer(body_, camera);
  renderer.distances(view(poses), window, observed, kMissing, distances);
  for (const double distance : distances) EXPECT_DOUBLE_EQ(distance, kMissing * kMissing * double(seen));
}

TEST_F(DepthRendererTest, RefusesOtherSizes) {
  const DepthRenderer renderer(body_, default_camera(160, 120));
  std::vector<float> images(19);
  std::vector<double> distances(20);
  EXPECT_THROW(renderer.images(view(poses_), {.width = 1, .height = 1}, images), std::invalid_argument);
  EXPECT_THROW(renderer.distances(view(poses_), {.width = 8, .height = 8}, Image<float>(8, 9), 1, distances),
               std::invalid_argument);
  EXPECT_THROW(
      renderer.distances({poses_.data(), 20, 3, 3}, {.width = 8, .height = 8}, Image<float>(8, 8), 1, distances),
      std::invalid_argument);
  EXPECT_THROW(DepthRenderer(nullptr, default_camera(160, 120)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
