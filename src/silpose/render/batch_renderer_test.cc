#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

using Counts = OutlineRenderer::Counts;

std::vector<double> random_poses(const Skeleton& skeleton, size_t count, uint64_t seed) {
  Rng rng(seed);
  std::vector<double> poses;
  for (size_t n = 0; n < count; ++n) {
    for (const Dof& dof : skeleton.dofs()) {
      poses.push_back(dof.is_translation ? rng.uniform(-0.5, 0.5) : rng.uniform(dof.lower, dof.upper));
    }
  }
  return poses;
}

class BatchRendererTest : public testing::Test {
 protected:
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  size_t num_dofs_ = static_cast<size_t>(body_->skeleton.num_dofs());
  PinholeCamera camera_ = default_camera(320, 240, 3.0);
  std::vector<double> poses_ = random_poses(body_->skeleton, 200, 1);

  BatchView view(const std::vector<double>& poses) const {
    return {poses.data(), poses.size() / num_dofs_, num_dofs_, num_dofs_};
  }
  std::span<const double> pose(size_t n) const { return std::span(poses_).subspan(n * num_dofs_, num_dofs_); }

  // Rounding in single precision may move a vertex by one grid step: a pixel here and there.
  void expect_counts_of_reference() {
    const Mask observed = render_silhouette(*body_, camera_, pose(0));
    std::vector<Counts> counts(200);
    BatchRenderer(body_, camera_).counts(view(poses_), {.width = 320, .height = 240}, observed, counts);
    int64_t area = 0;
    for (size_t n = 0; n < counts.size(); ++n) {
      const Mask mask = render_silhouette(*body_, camera_, pose(n));
      area += mask.count();
      EXPECT_NEAR(static_cast<double>(counts[n].model), static_cast<double>(mask.count()), 3) << n;
      EXPECT_NEAR(static_cast<double>(counts[n].both), static_cast<double>(and_count(mask, observed)), 3) << n;
    }
    EXPECT_GT(area, 200 * 1000);
  }
};

TEST_F(BatchRendererTest, CountsWhatTheReferenceDraws) { expect_counts_of_reference(); }

TEST_F(BatchRendererTest, CountsThroughADistortingLens) {
  camera_.distortion = {-0.3, 0.1, 0.004, -0.003, 0.02};
  expect_counts_of_reference();
}

TEST_F(BatchRendererTest, CountsFromATiltedCameraThatSeesOnlyAPart) {
  camera_ = look_at_camera(320, 240, 300, {0.6, 1.9, 0.9}, {0, 0.6, 0});
  expect_counts_of_reference();
}

TEST_F(BatchRendererTest, CountsInWindowsOf1024) {
  for (const double angle : {0.4, 2.0}) {
    camera_ = look_at_camera(640, 480, 600, {3 * std::sin(angle), 1.2, 3 * std::cos(angle)}, {0, 0.6, 0});
    const Window window{.x0 = 120, .y0 = 40, .scale_x = 2.56, .scale_y = 2.56, .width = 1024, .height = 1024};
    std::vector<Mask> masks;
    for (size_t n = 0; n < 3; ++n) {
      std::vector<Eigen::Vector2f> pixels(body_->rest.vertices.size());
      project_vertices(camera_, skin_vertices(*body_, pose(n)), pixels);
      draw_silhouette_reference(pixels, body_->rest.faces, window, masks.emplace_back());
    }
    std::vector<Counts> counts(3);
    BatchRenderer(body_, camera_).counts({poses_.data(), 3, num_dofs_, num_dofs_}, window, masks[0], counts);
    for (size_t n = 0; n < 3; ++n) {
      EXPECT_GT(masks[n].count(), 10'000);
      EXPECT_NEAR(static_cast<double>(counts[n].model), static_cast<double>(masks[n].count()), 12) << n;
      EXPECT_NEAR(static_cast<double>(counts[n].both), static_cast<double>(and_count(masks[n], masks[0])), 12) << n;
    }
  }
}

TEST_F(BatchRendererTest, CroppedCountsAgreeWithCroppedMasks) {
  const Mask observed = normalised_silhouette(render_silhouette(*body_, camera_, pose(0)), 64, 64);
  std::vector<Counts> counts(200);
  BatchRenderer(body_, camera_).counts_cropped(view(poses_), observed, counts);
  for (size_t n = 0; n < counts.size(); ++n) {
    const Mask image = render_silhouette(*body_, camera_, pose(n));
    const Box box = image.bounding_box();
    if (std::min(box.width, box.height) < 10) continue;  // hardly anything is left inside the image
    const Mask mask = normalised_silhouette(image, 64, 64);
    // The box of the pixels is up to half a pixel off the box of the vertices: a border of that width may differ.
    const double border = 2 * (64 + 64) * 64.0 / std::min(box.width, box.height);
    EXPECT_NEAR(static_cast<double>(counts[n].model), static_cast<double>(mask.count()), border) << n;
    EXPECT_NEAR(static_cast<double>(counts[n].both), static_cast<double>(and_count(mask, observed)), border) << n;
  }
  EXPECT_NEAR(static_cast<double>(counts[0].both), static_cast<double>(observed.count()), 0.05 * 64 * 64);
}

TEST_F(BatchRendererTest, ThreadsDoNotChangeCounts) {
  const Mask observed = render_silhouette(*body_, camera_, pose(7));
  std::vector<Counts> one(200), many(200);
  const BatchRenderer renderer(body_, camera_);
  {
    const ThreadLimit limit(1);
    renderer.counts(view(poses_), {.width = 320, .height = 240}, observed, one);
  }
  renderer.counts(view(poses_), {.width = 320, .height = 240}, observed, many);
  for (size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(one[n].model, many[n].model);
    EXPECT_EQ(one[n].both, many[n].both);
  }
}

TEST_F(BatchRendererTest, ReadsRowsAtTheirStride) {
  std::vector<double> wide;
  for (size_t n = 0; n < 3; ++n) {
    wide.insert(wide.end(), pose(n).begin(), pose(n).end());
    wide.insert(wide.end(), 5, 1e6);
  }
  const Mask observed = render_silhouette(*body_, camera_, pose(0));
  const Window window{.width = 320, .height = 240};
  std::vector<Counts> strided(3), plain(200);
  const BatchRenderer renderer(body_, camera_);
  renderer.counts({wide.data(), 3, num_dofs_, num_dofs_ + 5}, window, observed, strided);
  renderer.counts(view(poses_), window, observed, plain);
  for (size_t n = 0; n < 3; ++n) EXPECT_EQ(strided[n].both, plain[n].both);
}

TEST_F(BatchRendererTest, UnseenAndBrokenPosesCountNothing) {
  std::vector<double> poses(3 * num_dofs_, 0.0);
  poses[2] = 20;  // root_tz: behind the camera
  poses[num_dofs_] = std::numeric_limits<double>::quiet_NaN();
  poses[2 * num_dofs_] = 50;  // root_tx: outside the image
  const Mask observed(32, 32);
  std::vector<Counts> counts(3, {.model = 7, .both = 7});
  const BatchRenderer renderer(body_, camera_);
  renderer.counts(view(poses), {.scale_x = 0.1, .scale_y = 0.1, .width = 32, .height = 32}, observed, counts);
  for (const Counts& count : counts) EXPECT_EQ(count.model + count.both, 0);
  renderer.counts_cropped(view(poses), observed, counts);
  EXPECT_EQ(counts[0].model + counts[1].model, 0);
}

TEST_F(BatchRendererTest, SilhouettesAreWhatIsCounted) {
  const Window window{.x0 = 60, .y0 = 20, .scale_x = 0.7, .scale_y = 0.6, .width = 130, .height = 120};
  const BatchRenderer renderer(body_, camera_);
  std::vector<Mask> masks(200);
  renderer.silhouettes(view(poses_), window, masks);
  Mask full(window.width, window.height);
  for (int y = 0; y < full.height(); ++y) {
    for (int x = 0; x < full.width(); ++x) full.set(x, y);
  }
  std::vector<Counts> counts(200);
  renderer.counts(view(poses_), window, full, counts);
  for (size_t n = 0; n < counts.size(); ++n) EXPECT_EQ(masks[n].count(), counts[n].model) << n;
  EXPECT_GT(intersection_over_union(renderer.silhouette(pose(3)), render_silhouette(*body_, camera_, pose(3))), 0.999);
  std::vector<double> broken(pose(3).begin(), pose(3).end());
  broken[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(renderer.silhouette(broken).count(), 0);
}

TEST_F(BatchRendererTest, RefusesOtherSizes) {
  const BatchRenderer renderer(body_, camera_);
  std::vector<Counts> counts(200), few(3);
  EXPECT_THROW(renderer.counts(view(poses_), {.width = 8, .height = 8}, Mask(8, 9), counts), std::invalid_argument);
  EXPECT_THROW(renderer.counts(view(poses_), {.width = 8, .height = 8}, Mask(8, 8), few), std::invalid_argument);
  EXPECT_THROW(
      renderer.counts({poses_.data(), 1, 3, 3}, {.width = 8, .height = 8}, Mask(8, 8), std::span(few).first(1)),
      std::invalid_argument);
  EXPECT_THROW(BatchRenderer(nullptr, camera_), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
