#include "silpose/body/random_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(RandomPose, StaysInItsRange) {
  const BodyModel body = make_test_body();
  const std::vector<double> base = {0.1, 0.5, -0.1, 0.2, 0.1, 0, -0.1, 0.1};
  Rng rng(1);
  std::vector<double> least = base, most = base;
  for (int i = 0; i < 500; ++i) {
    const std::vector<double> pose = random_pose(body.skeleton, base, rng, {.part = 0.25, .shift_m = 0.3});
    for (size_t d = 0; d < base.size(); ++d) {
      least[d] = std::min(least[d], pose[d]);
      most[d] = std::max(most[d], pose[d]);
    }
  }
  for (size_t d = 0; d < base.size(); ++d) {
    const Dof& dof = body.skeleton.dofs()[d];
    const double lower = dof.is_translation ? base[d] - 0.3 : base[d] + 0.25 * (dof.lower - base[d]);
    const double upper = dof.is_translation ? base[d] + 0.3 : base[d] + 0.25 * (dof.upper - base[d]);
    EXPECT_GE(least[d], lower - 1e-12);
    EXPECT_LE(most[d], upper + 1e-12);
    EXPECT_LT(least[d], lower + 0.1 * (upper - lower));
    EXPECT_GT(most[d], upper - 0.1 * (upper - lower));
  }
}

TEST(RandomPose, NoRangeIsTheBase) {
  const BodyModel body = make_test_body();
  const std::vector<double> base(8, 0.1);
  Rng rng(1);
  EXPECT_EQ(random_pose(body.skeleton, base, rng, {.part = 0}), base);
  EXPECT_THROW((void)random_pose(body.skeleton, std::vector<double>(3), rng), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
