#include "silpose/track/limbs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/body/human.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(LimbBlocks, AChainIsOneLimb) {
  EXPECT_THAT(limb_blocks(make_test_body().skeleton), ElementsAre(ElementsAre(0, 1, 2, 3, 4, 5, 6, 7)));
}

TEST(LimbBlocks, AHumanHasHeadLegsArmsAndTrunk) {
  const Skeleton skeleton = human_skeleton(std::vector<Eigen::Vector3d>(20, Eigen::Vector3d::Zero()));
  const auto blocks = limb_blocks(skeleton);
  ASSERT_THAT(blocks, SizeIs(6));
  const std::vector<int> leg = {13, 14, 15, 16, 17};
  EXPECT_THAT(blocks, Contains(leg));
  EXPECT_EQ(blocks.back(), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));  // root, abdomen, thorax
  std::vector<int> seen(37, 0);
  for (const auto& block : blocks) {
    for (const int d : block) ++seen[static_cast<size_t>(d)];
  }
  EXPECT_THAT(seen, ::testing::Each(1));
}

TEST(ExchangedLimbs, SwapsLegsArmsAndBoth) {
  const Skeleton skeleton = human_skeleton(std::vector<Eigen::Vector3d>(20, Eigen::Vector3d::Zero()));
  std::vector<double> pose(37, 0.0);
  const auto at = [&](const char* name) { return static_cast<size_t>(*skeleton.find_dof(name)); };
  pose[at("right_thigh_rx")] = 0.5;
  pose[at("left_hand_rz")] = 0.2;
  pose[at("thorax_ry")] = 0.1;
  const auto variants = exchanged_limbs(skeleton, pose);
  ASSERT_THAT(variants, SizeIs(3));
  EXPECT_EQ(variants[0][at("left_thigh_rx")], 0.5);
  EXPECT_EQ(variants[0][at("right_thigh_rx")], 0);
  EXPECT_EQ(variants[0][at("left_hand_rz")], 0.2);
  EXPECT_EQ(variants[1][at("right_hand_rz")], 0.2);
  EXPECT_EQ(variants[1][at("right_thigh_rx")], 0.5);
  EXPECT_EQ(variants[2][at("left_thigh_rx")], 0.5);
  EXPECT_EQ(variants[2][at("right_hand_rz")], 0.2);
  for (const auto& variant : variants) EXPECT_EQ(variant[at("thorax_ry")], 0.1);
}

TEST(ExchangedLimbs, ABodyWithoutPairsHasNone) {
  EXPECT_TRUE(exchanged_limbs(make_test_body().skeleton, std::vector<double>(8, 0.0)).empty());
}

}  // namespace
}  // namespace silpose
