#include "silpose/segment/depth_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/rng.h"

namespace silpose {
namespace {

// A wall 4 m away, a floor that comes nearer below row 60, a subject 20 wide who walks 3 m away on that floor; noise of
// 1.4 mm times the squared metres, and pixels without an answer. 120x90.
struct Room {
  double unknown = 0.02;
  bool far_wall = false;  // out of the sensor's reach

  [[nodiscard]] static Mask subject(int x) {
    Mask mask(120, 90);
    for (int v = 15; v < 75; ++v) {
      for (int u = x; u < x + 20; ++u) mask.set(u, v);
    }
    return mask;
  }
  [[nodiscard]] DepthImage image(int x, uint64_t seed) const {
    const Mask mask = subject(x);
    DepthImage depth(120, 90);
    Rng rng(seed);
    for (int v = 0; v < 90; ++v) {
      for (int u = 0; u < 120; ++u) {
        double metres = v < 60 ? 4 : 4 - 0.05 * (v - 60);
        const bool is_unknown = rng.uniform() < unknown || (far_wall && v < 60);
        if (mask.get(u, v)) metres = 3;
        metres += 0.0014 * metres * metres * rng.normal();
        if (!is_unknown || mask.get(u, v)) depth.at(u, v) = static_cast<uint16_t>(std::lround(1000 * metres));
      }
    }
    return depth;
  }
};

double iou_of_walk(const Room& room, int step) {
  std::vector<DepthImage> images;
  for (int i = 0; i < 20; ++i) images.push_back(room.image(5 + step * i, 50u + i));
  const DepthImage background = learn_depth_background(images);
  double worst = 1;
  for (int i = 0; i < 20; i += 5) {
    worst = std::min(worst, intersection_over_union(nearer_than_background(images[static_cast<size_t>(i)], background),
                                                    Room::subject(5 + step * i)));
  }
  return worst;
}

TEST(DepthModel, FindsWhoStandsBeforeTheScene) { EXPECT_GT(iou_of_walk({}, 4), 0.98); }

TEST(DepthModel, SubjectMayStayForMostOfTheClip) {
  const Room room;
  std::vector<DepthImage> images;
  for (int i = 0; i < 20; ++i) images.push_back(room.image(i < 17 ? 40 : 90, 80u + i));
  const DepthImage background = learn_depth_background(images);
  EXPECT_GT(intersection_over_union(nearer_than_background(images[3], background), Room::subject(40)), 0.98);
}

TEST(DepthModel, WhatIsOutOfReachIsFarBehind) { EXPECT_GT(iou_of_walk({.far_wall = true}, 4), 0.98); }

TEST(DepthModel, BackgroundIsAQuantile) {
  std::vector<DepthImage> images;
  for (const uint16_t value : std::initializer_list<uint16_t>{1000, 3000, 0, 2000, 0, 2500})
    images.emplace_back(1, 1, 1, value);
  EXPECT_EQ(learn_depth_background(images).at(0, 0), 3000);
  for (int i = 0; i < 16; ++i) images.emplace_back(1, 1, 1, uint16_t{1000});
  EXPECT_EQ(learn_depth_background(images).at(0, 0), 2500);  // of 20 that are known one may be too far
  for (int i = 0; i < 20; ++i) images.emplace_back(1, 1, 1, uint16_t{0});
  EXPECT_EQ(learn_depth_background(images).at(0, 0), 65535);
}

TEST(DepthModel, NearerByMoreThanNoise) {
  const DepthImage wall(1, 1, 1, 4000);  // tolerance 30 mm + 6 mm * 16
  EXPECT_EQ(nearer_than_background(DepthImage(1, 1, 1, 3880), wall).count(), 0);
  EXPECT_EQ(nearer_than_background(DepthImage(1, 1, 1, 3870), wall).count(), 1);
  EXPECT_EQ(nearer_than_background(DepthImage(1, 1, 1, 0), wall).count(), 0);
}

TEST(DepthModel, EvidenceIsALogOfOdds) {
  const DepthImage wall(1, 1, 1, 4000);  // noise (30 + 6 * 16) / 3 = 42 mm; 4 m over sqrt(2 pi) is 1.5958 m
  const auto evidence = [&](uint16_t depth) { return depth_evidence(DepthImage(1, 1, 1, depth), wall).at(0, 0); };
  EXPECT_NEAR(evidence(4000), -std::log(1.5958 / 0.042), 1e-3);
  EXPECT_NEAR(evidence(4000 - 84), 2 - std::log(1.5958 / 0.042), 1e-3);
  EXPECT_EQ(evidence(4500), evidence(4000)) << "farther than the background";
  EXPECT_EQ(evidence(3000), 6);
  EXPECT_EQ(evidence(0), 0) << "unknown";
  EXPECT_EQ(depth_evidence(DepthImage(1, 1, 1, 3000), DepthImage(1, 1, 1, 65535)).at(0, 0), 6) << "out of reach";
}

TEST(DepthModel, RangeIncludesItsEndsAndNothingUnknown) {
  const DepthRange range{0, 2.5};
  EXPECT_EQ(within_depth_range(DepthImage(1, 1, 1, 2500), range).count(), 1);
  EXPECT_EQ(within_depth_range(DepthImage(1, 1, 1, 2501), range).count(), 0);
  EXPECT_EQ(within_depth_range(DepthImage(1, 1, 1, 0), range).count(), 0);
  EXPECT_EQ(within_depth_range(DepthImage(70, 2, 1, 1), range).count(), 140);
}

}  // namespace
}  // namespace silpose
