#include "silpose/synth/degraded_mask.h"

#include <gmock/gmock.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/body/test_body.h"
#include "silpose/render/silhouette.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

MaskNoise edge(double iou, uint64_t seed = 1) {
  return {.fault = MaskFault::kEdge, .iou = iou, .outline = {}, .seed = seed};
}
MaskNoise of(MaskFault fault, uint64_t seed = 1) { return {.fault = fault, .iou = 0.9, .outline = {}, .seed = seed}; }

double mean_iou(const SyntheticSequence& sequence, const std::vector<Mask>& masks) {
  double sum = 0;
  for (int frame = sequence.lead_in; frame < sequence.num_frames(); ++frame) {
    sum += intersection_over_union(masks[static_cast<size_t>(frame)], true_mask(sequence, 0, frame));
  }
  return sum / static_cast<double>(sequence.poses.size());
}

int64_t outside(const Mask& mask, const Mask& truth) { return mask.count() - and_count(mask, truth); }

// A body that stands still, larger than the test scene: what changes is the noise.
SyntheticSequence make_still_scene(int num_frames, double azimuth_deg = 20) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  SyntheticMotion motion;
  motion.poses.assign(static_cast<size_t>(num_frames), standing_pose(*body));
  return make_sequence(body, motion,
                       {.width = 320, .height = 240, .focal_px = 400, .distance_m = 4, .views = {{"it", azimuth_deg}}})
      .value();
}

TEST(DegradedMasks, NoneIsTheTruth) {
  const SyntheticSequence sequence = make_test_scene(4, 2);
  const std::vector<Mask> masks = degraded_masks(sequence, 0, {}).value();
  ASSERT_EQ(masks.size(), 6U);
  for (int frame = 0; frame < 6; ++frame) EXPECT_EQ(masks[static_cast<size_t>(frame)], true_mask(sequence, 0, frame));
  EXPECT_EQ(DegradedMasks::create(sequence, 0, {}).value().mean_iou(), 1);
}

TEST(DegradedMasks, EdgeMeetsTheWantedMean) {
  for (const SyntheticSequence& sequence : {make_test_scene(20, 3), make_still_scene(20)}) {
    for (const double wanted : {0.95, 0.9, 0.8}) {
      const DegradedMasks degraded = DegradedMasks::create(sequence, 0, edge(wanted)).value();
      const std::vector<Mask> masks = degraded_masks(sequence, 0, edge(wanted)).value();
      EXPECT_NEAR(mean_iou(sequence, masks), wanted, 0.01);
      EXPECT_NEAR(degraded.mean_iou(), mean_iou(sequence, masks), 1e-12);
      EXPECT_EQ(masks[0].count() == 0, sequence.lead_in > 0);
    }
  }
}

TEST(DegradedMasks, EdgeErrsBothWaysUnlessBiased) {
  const SyntheticSequence sequence = make_still_scene(30);
  const double area = static_cast<double>(true_mask(sequence, 0, 0).count());
  const auto mean_area = [&](double bias) {
    MaskNoise noise = edge(0.85);
    noise.outline.bias = bias;
    double sum = 0;
    for (const Mask& mask : degraded_masks(sequence, 0, noise).value()) sum += static_cast<double>(mask.count());
    return sum / 30 / area;
  };
  EXPECT_NEAR(mean_area(0), 1, 0.08);  // few places and times err apart
  EXPECT_GT(mean_area(2), 1.1);
  EXPECT_LT(mean_area(-2), 0.9);
}

TEST(DegradedMasks, EdgeIsCorrelatedOverTimeAndFollowsTheSeed) {
  const SyntheticSequence sequence = make_still_scene(60);
  const std::vector<Mask> masks = degraded_masks(sequence, 0, edge(0.9)).value();
  double next = 0, later = 0;
  for (size_t t = 0; t + 20 < masks.size(); ++t) {
    next += static_cast<double>(xor_count(masks[t], masks[t + 1]));
    later += static_cast<double>(xor_count(masks[t], masks[t + 20]));  // 0.67 s
  }
  EXPECT_GT(next, 0);
  EXPECT_LT(next, later / 4);
  EXPECT_EQ(masks, degraded_masks(sequence, 0, edge(0.9)).value());
  EXPECT_NE(masks, degraded_masks(sequence, 0, edge(0.9, 2)).value());
}

TEST(DegradedMasks, DoNotDependOnThreads) {
  const SyntheticSequence sequence = make_test_scene(8);
  for (const MaskFault fault : {MaskFault::kEdge, MaskFault::kHole, MaskFault::kLimb, MaskFault::kShadow}) {
    const std::vector<Mask> masks = degraded_masks(sequence, 0, of(fault)).value();
    const ThreadLimit one(1);
    EXPECT_EQ(masks, degraded_masks(sequence, 0, of(fault)).value());
  }
}

TEST(OutlineNoise, TurnsOverOncePerCorrelationLengthNotPerPixel) {
  // A half-plane whose straight outline is 2,000 px long: signs of the displacement along it. A Gaussian process of
  // kernel exp(-d^2 / 2 L^2) changes sign once in pi L: 2000 / (pi 20) = 32 times.
  Mask mask(2000, 60);
  for (int x = 0; x < 2000; ++x) {
    for (int y = 30; y < 60; ++y) mask.set(x, y);
  }
  double crossings = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    std::vector<int> sign(2000, -1);  // the pixel just outside is added where the outline goes out
    for (const auto& change : OutlineNoise({}, seed, 1).changes(mask, 200, 0)) {
      if (change.y == 29) sign[static_cast<size_t>(change.x)] = 1;
    }
    for (size_t x = 1; x < 2000; ++x) crossings += sign[x] != sign[x - 1];
  }
  EXPECT_NEAR(crossings / 8, 32, 8);
}

TEST(OutlineNoise, ChangesPixelsFromTheOutlineOn) {
  const SyntheticSequence sequence = make_still_scene(1);
  const Mask truth = true_mask(sequence, 0, 0);
  Image<float> at(truth.width(), truth.height(), 1);
  for (const auto& change : OutlineNoise({.bias = 10}, 1, 1).changes(truth, 200, 0)) {
    EXPECT_FALSE(truth.get(change.x, change.y));  // it only grows
    at.row(change.y)[static_cast<size_t>(change.x)] = static_cast<float>(change.amplitude);
  }
  const Box box = truth.bounding_box();
  const auto row = at.row(box.y + box.height / 2);
  int first = 0;
  while (!truth.get(first, box.y + box.height / 2)) ++first;
  const auto x = static_cast<size_t>(first);
  EXPECT_GT(row[x - 1], 0);  // half a pixel by about ten deviations
  EXPECT_NEAR(row[x - 2] / row[x - 1], 3, 0.5);
  EXPECT_NEAR(row[x - 5] / row[x - 1], 9, 1.5);
}

TEST(DegradedMasks, ShadowIsJoinedToTheFeet) {
  const SyntheticSequence sequence =
      make_still_scene(1, 200);  // the light shines from the front: it falls to the camera
  const Mask truth = true_mask(sequence, 0, 0), mask = degraded_masks(sequence, 0, of(MaskFault::kShadow)).value()[0];
  EXPECT_EQ(and_count(mask, truth), truth.count());
  EXPECT_GT(outside(mask, truth), truth.count() / 20);
  const Box box = truth.bounding_box();
  for (int y = 0; y < box.y + box.height / 2; ++y) {  // above the middle of the body there is none
    for (int x = 0; x < mask.width(); ++x) EXPECT_EQ(mask.get(x, y), truth.get(x, y));
  }
  int joined = 0;
  for (int x = 0; x < mask.width(); ++x) {
    int lowest = box.y + box.height - 1;
    while (lowest > box.y && !truth.get(x, lowest)) --lowest;
    joined += truth.get(x, lowest) && mask.get(x, lowest + 1);
  }
  EXPECT_GT(joined, box.width / 2);
}

TEST(DegradedMasks, HolesAreInsideAndComeAndGo) {
  const SyntheticSequence sequence = make_still_scene(90);
  const Mask truth = true_mask(sequence, 0, 0);
  const std::vector<Mask> masks = degraded_masks(sequence, 0, of(MaskFault::kHole)).value();
  int with_holes = 0;
  for (const Mask& mask : masks) {
    EXPECT_EQ(outside(mask, truth), 0);
    EXPECT_GT(mask.count(), truth.count() * 8 / 10);
    with_holes += mask.count() < truth.count();
    for (int y = 1; y + 1 < truth.height(); ++y) {
      for (int x = 1; x + 1 < truth.width(); ++x) {  // a rim is left
        const bool is_hole = truth.get(x, y) && !mask.get(x, y);
        ASSERT_TRUE(!is_hole || (truth.get(x - 1, y - 1) && truth.get(x + 1, y + 1)));
      }
    }
  }
  EXPECT_GT(with_holes, 60);
  EXPECT_NE(masks[20], masks[40]);
}

TEST(DegradedMasks, ALimbIsMissingForStretches) {
  const SyntheticSequence sequence = make_still_scene(150);
  const Mask truth = true_mask(sequence, 0, 0);
  const std::vector<Mask> masks = degraded_masks(sequence, 0, of(MaskFault::kLimb)).value();
  int missing = 0, switches = 0;
  for (size_t t = 0; t < masks.size(); ++t) {
    EXPECT_EQ(outside(masks[t], truth), 0);
    if (masks[t] != truth) {
      ++missing;
      EXPECT_LT(masks[t].count(), truth.count() * 9 / 10);
    }
    if (t > 0) switches += (masks[t] == truth) != (masks[t - 1] == truth);
  }
  EXPECT_GT(missing, 30);
  EXPECT_LT(missing, 120);
  EXPECT_GE(switches, 4);
  EXPECT_LE(switches, 20);  // stretches of at least 0.2 s
}

TEST(DegradedMasks, NamesWhatCannotBe) {
  const SyntheticSequence sequence = make_test_scene(2);
  EXPECT_THAT(parse_mask_fault("fog").error().message, testing::HasSubstr("fog"));
  EXPECT_EQ(parse_mask_fault("edge").value(), MaskFault::kEdge);
  EXPECT_THAT(DegradedMasks::create(sequence, 0, edge(0.05)).error().message, testing::HasSubstr("0.050"));
  EXPECT_THROW((void)DegradedMasks::create(sequence, 1, {}), std::invalid_argument);
  EXPECT_THROW((void)DegradedMasks::create(sequence, 0, edge(1)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
