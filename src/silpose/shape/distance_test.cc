#include "silpose/shape/distance.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace silpose {
namespace {

TEST(DepthSsd, SquaresDifferencesAndCountsWhatIsMissing) {
  Image<float> a(3, 2), b(3, 2);
  a.at(0, 0) = 2.0f, b.at(0, 0) = 2.5f;
  a.at(1, 0) = 3.0f, b.at(1, 0) = 3.0f;
  a.at(2, 1) = 4.0f;
  b.at(0, 1) = 1.0f;
  EXPECT_DOUBLE_EQ(depth_ssd(a, b, 0.3), 0.25 + 2 * 0.09);
  EXPECT_DOUBLE_EQ(depth_ssd(a, a, 0.3), 0);
  EXPECT_THROW((void)depth_ssd(a, Image<float>(2, 3), 1), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
