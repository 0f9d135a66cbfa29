// The contract of RenderBackend, for every backend there is; a new one is one line at the end.
#include "silpose/render/render_backend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"
#include "silpose/shape/distance.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

struct Case {
  std::string name;
  MakeRenderBackend make;
};

constexpr int kNumPoses = 20;

class RenderBackendContract : public testing::TestWithParam<Case> {
 protected:
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(160, 120, 150, {0.5, 1.2, 3}, {0, 0.6, 0});
  size_t num_dofs_ = static_cast<size_t>(body_->skeleton.num_dofs());
  std::vector<double> poses_ = random_poses();
  Window window_ = {.x0 = 20, .y0 = 5, .scale_x = 0.7, .scale_y = 0.7, .width = 80, .height = 70};

  std::vector<double> random_poses() const {
    Rng rng(1);
    std::vector<double> poses;
    for (size_t i = 0; i < kNumPoses * num_dofs_; ++i) poses.push_back(rng.uniform(-0.4, 0.4));
    return poses;
  }
  BatchView batch() const { return batch(poses_); }
  BatchView batch(const std::vector<double>& poses) const {
    return {poses.data(), poses.size() / num_dofs_, num_dofs_, num_dofs_};
  }
  static ByteImage coverage_of(const Mask& samples) {
    ByteImage coverage(samples.width() / kCoverageSamples, samples.height() / kCoverageSamples);
    for (int y = 0; y < samples.height(); ++y) {
      for (int x = 0; x < samples.width(); ++x) {
        uint8_t& of_pixel = coverage.at(x / kCoverageSamples, y / kCoverageSamples);
        of_pixel = static_cast<uint8_t>(of_pixel + samples.get(x, y));
      }
    }
    return coverage;
  }
  std::vector<Mask> drawn(const RenderBackend& backend, const Framing& framing) const {
    std::vector<Mask> masks(kNumPoses);
    backend.silhouettes(batch(), framing, masks);
    return masks;
  }
  std::shared_ptr<const RenderBackend> backend_ = GetParam().make(body_, camera_);
  std::shared_ptr<const RenderBackend> reference_ = make_reference_backend(body_, camera_);
};

TEST_P(RenderBackendContract, DrawsWhatTheReferenceDraws) {
  for (const bool cropped : {false, true}) {
    const Framing framing{window_, cropped};
    const auto ours = drawn(*backend_, framing), theirs = drawn(*reference_, framing);
    int64_t differing = 0, set = 0;
    for (size_t n = 0; n < ours.size(); ++n) {
      ASSERT_EQ(ours[n].width(), window_.width);
      ASSERT_EQ(ours[n].height(), window_.height);
      differing += xor_count(ours[n], theirs[n]);
      set += theirs[n].count();
    }
    EXPECT_GT(set, kNumPoses * 200);
    EXPECT_LE(differing, set / 2000 + 2);  // vertices may be rounded to the next 1/256 pixel
  }
}

TEST_P(RenderBackendContract, DepthsAreThoseOfTheReference) {
  const size_t size = static_cast<size_t>(window_.width) * static_cast<size_t>(window_.height);
  std::vector<float> ours(kNumPoses * size), theirs(kNumPoses * size);
  backend_->depths(batch(), window_, ours);
  reference_->depths(batch(), window_, theirs);
  int64_t differing = 0, set = 0;
  for (size_t i = 0; i < ours.size(); ++i) {
    set += theirs[i] > 0;
    differing += (ours[i] == 0) != (theirs[i] == 0) || std::abs(ours[i] - theirs[i]) > 1e-3f;
  }
  EXPECT_GT(set, kNumPoses * 200);
  EXPECT_LE(differing, set / 2000 + 2);
}

TEST_P(RenderBackendContract, WhatIsFusedGivesWhatDrawingGives) {
  for (const bool cropped : {false, true}) {
    const Framing framing{window_, cropped};
    const auto masks = drawn(*backend_, framing);
    std::vector<OutlineRenderer::Counts> counts(kNumPoses);
    if (!backend_->counts(batch(), framing, masks[3], counts)) continue;
    for (size_t n = 0; n < masks.size(); ++n) {
      EXPECT_EQ(counts[n].model, masks[n].count()) << n;
      EXPECT_EQ(counts[n].both, and_count(masks[n], masks[3])) << n;
    }
  }
  for (const bool cropped : {false, true}) {
    const auto fine = drawn(*backend_, {sample_window(window_), cropped});
    const ByteImage covered = coverage_of(fine[3]);
    std::vector<OutlineRenderer::Counts> counts(kNumPoses);
    if (!backend_->coverages(batch(), {window_, cropped}, covered, counts)) continue;
    for (size_t n = 0; n < fine.size(); ++n) {
      const ByteImage own = coverage_of(fine[n]);
      int64_t both = 0;
      for (size_t i = 0; i < own.pixels().size(); ++i) both += std::min(own.pixels()[i], covered.pixels()[i]);
      EXPECT_EQ(counts[n].model, fine[n].count()) << n;
      EXPECT_EQ(counts[n].both, both) << n;
    }
  }
  Image<float> observed(window_.width, window_.height);
  backend_->depths({poses_.data(), 1, num_dofs_, num_dofs_}, window_, observed.pixels());
  std::vector<double> distances(kNumPoses);
  if (backend_->depth_distances(batch(), window_, observed, 0.5, distances)) {
    Image<float> image(window_.width, window_.height);
    for (size_t n = 0; n < distances.size(); ++n) {
      backend_->depths({poses_.data() + n * num_dofs_, 1, num_dofs_, num_dofs_}, window_, image.pixels());
      EXPECT_NEAR(distances[n], depth_ssd(image, observed, 0.5), 1e-4 * (1 + distances[n])) << n;
    }
  }
}

TEST_P(RenderBackendContract, UnseenAndBrokenPosesShowNothing) {
  std::vector<double> poses(3 * num_dofs_, 0.0);
  poses[2] = 20;  // behind the camera
  poses[num_dofs_] = std::numeric_limits<double>::quiet_NaN();
  poses[2 * num_dofs_] = 50;  // outside the image
  std::vector<Mask> masks(3, Mask(1, 1));
  std::vector<float> depths(3 * 80 * 70, 7);
  for (const bool cropped : {false, true}) {
    backend_->silhouettes(batch(poses), {window_, cropped}, masks);
    for (const Mask& mask : masks) EXPECT_EQ(mask, Mask(80, 70));
  }
  backend_->depths(batch(poses), window_, depths);
  EXPECT_TRUE(std::ranges::all_of(depths, [](float depth) { return depth == 0; }));
}

TEST_P(RenderBackendContract, NeitherTheBatchNorThreadsChangeASilhouette) {
  const auto all = drawn(*backend_, {window_});
  Mask alone;
  backend_->silhouettes({poses_.data() + 7 * num_dofs_, 1, num_dofs_, num_dofs_}, {window_}, {&alone, 1});
  EXPECT_EQ(alone, all[7]);
  const ThreadLimit limit(1);
  EXPECT_EQ(drawn(*backend_, {window_}), all);
}

TEST_P(RenderBackendContract, RefusesWrongShapes) {
  std::vector<Mask> masks(3);
  std::vector<float> depths(5);
  EXPECT_THROW(backend_->silhouettes(batch(), {window_}, masks), std::invalid_argument);
  EXPECT_THROW(backend_->depths(batch(), window_, depths), std::invalid_argument);
  EXPECT_THROW(backend_->silhouettes({poses_.data(), 3, 3, 3}, {window_}, masks), std::invalid_argument);
  const Mask small(3, 3);
  std::vector<OutlineRenderer::Counts> counts(kNumPoses);
  if (GetParam().name != "Reference") {
    EXPECT_THROW((void)backend_->counts(batch(), {window_}, small, counts), std::invalid_argument);
    EXPECT_THROW((void)backend_->counts(batch(), {window_, true}, small, counts), std::invalid_argument);
  }
  EXPECT_THROW((void)GetParam().make(nullptr, camera_), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(All, RenderBackendContract,
                         testing::Values(Case{"Cpu", make_cpu_backend}, Case{"Reference", make_reference_backend}),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace silpose
