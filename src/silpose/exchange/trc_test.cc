#include "silpose/exchange/trc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

class Trc : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) / "markers.trc";
};

TEST_F(Trc, HoldsHeaderPositionsAndBlanks) {
  const MarkerTable table{.names = {"root", "head_top"},
                          .rows = {{10, 0.4, {{0.1, 1, -2}, {0, 1.5, -2.25}}}, {11, 0.44, {}}}};
  ASSERT_TRUE(write_trc(path_, table, 25).ok());
  EXPECT_EQ(read_text_file(path_).value(),
            "PathFileType\t4\t(X/Y/Z)\tmarkers.trc\n"
            "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
            "25.000000\t25.000000\t2\t2\tm\t25.000000\t10\t2\n"
            "Frame#\tTime\troot\t\t\thead_top\t\t\t\n"
            "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\t\n"
            "\n"
            "10\t0.400000\t0.100000\t1.000000\t-2.000000\t0.000000\t1.500000\t-2.250000\t\n"
            "11\t0.440000\t\t\t\t\t\t\t\n");
}

TEST_F(Trc, RefusesWhatIsNoMarkerTable) {
  EXPECT_THROW((void)write_trc(path_, {}, 30), std::invalid_argument);
  EXPECT_THROW((void)write_trc(path_, {.names = {"a"}}, 0), std::invalid_argument);
  EXPECT_THROW((void)write_trc(path_, {.names = {"a"}, .rows = {{0, 0, {{0, 0, 0}, {0, 0, 0}}}}}, 30),
               std::invalid_argument);
  EXPECT_THROW((void)write_trc(path_, {.names = {"a"}, .rows = {{0, 0, {{0, NAN, 0}}}}}, 30), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_THAT(write_trc("no/such/place.trc", {.names = {"a"}}, 30).error().message,
              testing::HasSubstr("no/such/place.trc: cannot be written"));
}

}  // namespace
}  // namespace silpose
