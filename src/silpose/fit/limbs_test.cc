#include "silpose/fit/limbs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(LimbBlocks, AChainIsOneLimbOnItsRoot) {
  EXPECT_THAT(limb_blocks(make_test_body()), ElementsAre(ElementsAre(4, 5, 6, 7), ElementsAre(0, 1, 2, 3)));
}

TEST(LimbBlocks, AHumanHasHeadLegsArmsAndTrunk) {
  const auto blocks = limb_blocks(*human_for_test());
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

}  // namespace
}  // namespace silpose
