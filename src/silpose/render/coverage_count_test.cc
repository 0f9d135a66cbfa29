#include "silpose/render/coverage_count.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"
#include "silpose/body/test_body.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

using Counts = OutlineRenderer::Counts;
using Pixels = std::vector<Eigen::Vector2f>;

Counts counts_of(const ByteImage& model, const ByteImage& observed) {
  Counts counts;
  for (size_t i = 0; i < model.pixels().size(); ++i) {
    counts.model += model.pixels()[i];
    counts.both += std::min(model.pixels()[i], observed.pixels()[i]);
  }
  return counts;
}

ByteImage any_coverage(int width, int height, Rng& rng) {
  ByteImage image(width, height);
  for (uint8_t& value : image.pixels()) {
    value = static_cast<uint8_t>(std::clamp(rng.uniform(-40, 100), 0.0, double(kFullCoverage)));
  }
  return image;
}

class CoverageCountTest : public testing::Test {
 protected:
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  size_t num_dofs_ = static_cast<size_t>(body_->skeleton.num_dofs());
  PinholeCamera camera_ = look_at_camera(160, 120, 150, {0.5, 1.2, 3}, {0, 0.6, 0});
  std::vector<double> pose_ = {0.1, 0.5, -0.2, 0.4, 0.3, 0.2, -0.4, 0.5};

  Pixels pixels(std::span<const double> pose) const {
    ProjectedMesh mesh;
    project_mesh(camera_, skin_vertices(*body_, pose), body_->rest.faces, mesh);
    return mesh.pixels;
  }
  ByteImage reference(const Window& window) const {
    return draw_coverage_reference(pixels(pose_), body_->rest.faces, window);
  }
};

TEST_F(CoverageCountTest, EveryInstructionSetCountsWhatTheReferenceDraws) {
  Rng rng(1);
  const EdgeTopology topology(body_->rest.faces);
  OutlineRenderer renderer(topology);
  // Widths and origins that fill no word, rows that begin within a pixel, silhouettes cut by every border.
  for (const Window& window :
       {Window{.width = 160, .height = 120}, Window{.x0 = 61.3, .y0 = 40.7, .width = 37, .height = 21},
        Window{.x0 = -9, .y0 = -7, .scale_x = 0.21, .scale_y = 0.4, .width = 45, .height = 50},
        Window{.x0 = 500, .width = 9, .height = 9}}) {
    const ByteImage model = reference(window);
    const ByteImage observed = any_coverage(window.width, window.height, rng);
    const Counts expected = counts_of(model, observed);
    for_each_simd_target([&](const char* name) {
      const Counts counts = renderer.count_coverage(pixels(pose_), window, observed);
      EXPECT_EQ(counts.model, expected.model) << name;
      EXPECT_EQ(counts.both, expected.both) << name;
    });
  }
}

TEST_F(CoverageCountTest, EveryPixelIsCountedWhereItIs) {
  const EdgeTopology topology(body_->rest.faces);
  OutlineRenderer renderer(topology);
  const Window window{.x0 = 40, .y0 = 20, .scale_x = 0.25, .scale_y = 0.25, .width = 19, .height = 23};
  const ByteImage model = reference(window);
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      ByteImage one(window.width, window.height);
      one.at(x, y) = kFullCoverage;
      EXPECT_EQ(renderer.count_coverage(pixels(pose_), window, one).both, model.at(x, y)) << x << ", " << y;
    }
  }
}

TEST_F(CoverageCountTest, IsNearTheAreaThatManyMoreSamplesFind) {
  constexpr int kMore = 64;  // along each axis
  const Window window{.x0 = 30, .y0 = 10, .scale_x = 0.3, .scale_y = 0.3, .width = 30, .height = 30};
  const ByteImage model = reference(window);
  Mask samples;
  draw_silhouette_reference(pixels(pose_), body_->rest.faces,
                            {.x0 = window.x0,
                             .y0 = window.y0,
                             .scale_x = kMore * window.scale_x,
                             .scale_y = kMore * window.scale_y,
                             .width = kMore * window.width,
                             .height = kMore * window.height},
                            samples);
  double worst = 0, sum = 0, area = 0;
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) {
      double exact = 0;
      for (int j = 0; j < kMore; ++j) {
        for (int i = 0; i < kMore; ++i) exact += samples.get(kMore * x + i, kMore * y + j);
      }
      exact /= kMore * kMore;
      const double error = model.at(x, y) / double(kFullCoverage) - exact;
      worst = std::max(worst, std::abs(error));
      sum += error;
      area += exact;
    }
  }
  EXPECT_GT(area, 50);
  EXPECT_LT(worst, 1.0 / 16);
  EXPECT_LT(std::abs(sum), 5e-3 * area);
}

TEST_F(CoverageCountTest, AnUprightEdgeMovesByEighths) {
  const Window window{.width = 8, .height = 4};
  const std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}};
  for (int i = 0; i < 64; ++i) {
    const float x = 3 + static_cast<float>(i) / 64;
    const ByteImage image = draw_coverage_reference(Pixels{{1, 1}, {x, 1}, {x, 3}, {1, 3}}, faces, window);
    EXPECT_EQ(image.at(2, 1), kFullCoverage);
    EXPECT_EQ(image.at(3, 1), 8 * ((i + 3) / 8));
    EXPECT_EQ(image.at(0, 1), 0);
  }
}

TEST_F(CoverageCountTest, BatchesCountWhatTheReferenceDraws) {
  Rng rng(2);
  constexpr size_t kPoses = 50;
  std::vector<double> poses;
  for (size_t n = 0; n < kPoses; ++n) {
    for (size_t d = 0; d < num_dofs_; ++d) poses.push_back(pose_[d] + rng.uniform(-0.4, 0.4));
  }
  const BatchView view{poses.data(), kPoses, num_dofs_, num_dofs_};
  for (const double k1 : {0.0, -0.15}) {
    camera_.distortion[0] = k1;
    const BatchRenderer renderer(body_, camera_);
    const Window window{.scale_x = 0.25, .scale_y = 0.25, .width = 40, .height = 30};
    const ByteImage observed = any_coverage(40, 30, rng);
    std::vector<Counts> counts(kPoses), one_thread(kPoses);
    renderer.coverages(view, window, observed, counts);
    for (size_t n = 0; n < kPoses; ++n) {
      const auto drawn = pixels(std::span(poses).subspan(n * num_dofs_, num_dofs_));
      const Counts expected = counts_of(draw_coverage_reference(drawn, body_->rest.faces, window), observed);
      // Rounding in single precision may move a vertex by one grid step: a sample here and there.
      EXPECT_NEAR(double(counts[n].model), double(expected.model), 3);
      EXPECT_NEAR(double(counts[n].both), double(expected.both), 3);
    }
    const ThreadLimit limit(1);
    renderer.coverages(view, window, observed, one_thread);
    for (size_t n = 0; n < kPoses; ++n) EXPECT_EQ(counts[n].both, one_thread[n].both);
  }
}

TEST_F(CoverageCountTest, CroppedSilhouettesFillTheirRaster) {
  const Mask mask = render_silhouette(*body_, camera_, pose_);
  const ByteImage observed = resample_coverage(mask, window_of(mask.bounding_box(), 24, 24), kFullCoverage);
  Counts counts;
  BatchRenderer(body_, camera_).coverages_cropped({pose_.data(), 1, num_dofs_, num_dofs_}, observed, {&counts, 1});
  int64_t area = 0;
  for (const uint8_t value : observed.pixels()) area += value;
  // Boxes of pixels and of vertices are up to half a pixel apart.
  EXPECT_NEAR(double(counts.model), double(area), 0.05 * double(area));
  EXPECT_GT(double(counts.both), 0.94 * double(area));
}

TEST_F(CoverageCountTest, RefusesOtherSizes) {
  const BatchRenderer renderer(body_, camera_);
  Counts counts;
  const BatchView view{pose_.data(), 1, num_dofs_, num_dofs_};
  EXPECT_THROW(renderer.coverages(view, {.width = 8, .height = 8}, ByteImage(8, 9), {&counts, 1}),
               std::invalid_argument);
  EXPECT_THROW(renderer.coverages(view, {.width = 8, .height = 8}, ByteImage(8, 8, 1, 65), {&counts, 1}),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
