#include "silpose/exchange/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Tables : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("tables_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  const std::filesystem::path& write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }

  std::filesystem::path path_;
};

Skeleton two_dofs() {
  return Skeleton("two", {{"root", -1, {0, 0, 0}, {0}}, {"tip", 0, {0, 1, 0}, {1}}},
                  {{.name = "root_tx",
                    .joint_idx = 0,
                    .is_translation = true,
                    .is_periodic = false,
                    .axis = Eigen::Vector3d::UnitX(),
                    .lower = -1,
                    .upper = 1},
                   {.name = "tip_rz",
                    .joint_idx = 1,
                    .is_translation = false,
                    .is_periodic = false,
                    .axis = Eigen::Vector3d::UnitZ(),
                    .lower = -1,
                    .upper = 1}});
}

TEST_F(Tables, WritesPosesInMetresAndDegrees) {
  PoseTable table{.rows = {{0, 0, {0.25, kPi / 6}, 0.5, 12.25}, {7, 0.2333333333, {-1e-9, -kPi}, 1, 3}},
                  .has_scores = true};
  ASSERT_TRUE(write_poses(path_, two_dofs(), table).ok());
  EXPECT_EQ(read_text_file(path_).value(),
            "frame,time_s,root_tx_m,tip_rz_deg,visual_accuracy,effective_sample_size\n"
            "0,0.000000,0.250000,30.000000,0.500000,12.250\n"
            "7,0.233333,0.000000,-180.000000,1.000000,3.000\n");
  table.has_scores = false;
  ASSERT_TRUE(write_poses(path_, two_dofs(), table, PoseUnits::kNormalised).ok());
  EXPECT_THAT(read_text_file(path_).value(),
              testing::StartsWith("frame,time_s,root_tx_m,tip_rz_deg\n0,0.000000,0.25000000,0.52359878\n"));
}

TEST_F(Tables, PosesComeBack) {
  PoseTable table{.rows = {}, .has_scores = true};
  for (int frame = 3; frame < 40; frame += 2) {
    table.rows.push_back({frame, frame / 30.0, {std::sin(frame), 3 * std::cos(frame)}, 0.9, 1.0 * frame});
  }
  table.rows[4].visual_accuracy = std::nan("");
  for (const PoseUnits units : {PoseUnits::kNatural, PoseUnits::kNormalised}) {
    ASSERT_TRUE(write_poses(path_, two_dofs(), table, units).ok());
    const PoseTable again = read_poses(path_, two_dofs(), units).value();
    EXPECT_TRUE(again.has_scores);
    ASSERT_EQ(again.rows.size(), table.rows.size());
    for (size_t r = 0; r < table.rows.size(); ++r) {
      EXPECT_EQ(again.rows[r].frame, table.rows[r].frame);
      EXPECT_NEAR(again.rows[r].time_s, table.rows[r].time_s, 1e-6);
      for (size_t d = 0; d < 2; ++d) EXPECT_NEAR(again.rows[r].values[d], table.rows[r].values[d], 1e-6);
      EXPECT_EQ(again.rows[r].effective_sample_size, table.rows[r].effective_sample_size);
    }
    EXPECT_TRUE(std::isnan(again.rows[4].visual_accuracy));
  }
}

TEST_F(Tables, ReadsColumnsInAnyOrder) {
  write("\xef\xbb\xbftip_rz_deg, time_s ,frame,root_tx_m\r\n90,0.5,+4,1e-1\r\n\r\n");
  const PoseTable table = read_poses(path_, two_dofs()).value();
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_FALSE(table.has_scores);
  EXPECT_EQ(table.rows[0].frame, 4);
  EXPECT_NEAR(table.rows[0].values[0], 0.1, 1e-12);
  EXPECT_NEAR(table.rows[0].values[1], kPi / 2, 1e-12);
}

TEST_F(Tables, AHeaderAloneIsATableWithoutRows) {
  EXPECT_TRUE(read_poses(write("frame,time_s,root_tx_m,tip_rz_deg\n"), two_dofs()).value().rows.empty());
}

TEST_F(Tables, NamesFileAndLineOfBadPoses) {
  const std::string header = "frame,time_s,root_tx_m,tip_rz_deg\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is empty"},
      {"\n\n", "is empty"},
      {"frame,time_s,root_tx_m\n", "line 1: column 'tip_rz_deg' is missing"},
      {"frame,time_s,root_tx_m,tip_rz_deg,tail_rx_deg\n", "line 1: unknown column 'tail_rx_deg'"},
      {"frame,time_s,root_tx_m,tip_rz_deg,frame\n", "line 1: a second column 'frame'"},
      {header + "0,0,1,2\n1,0.1,nan,2\n", "line 3: root_tx_m: 'nan' is not a finite number"},
      {header + "0,0,1e300,2\n", "line 2: 1e300 is not within 1000000 metres or degrees of zero"},
      {header + "0,0,1,\n", "line 2: tip_rz_deg: '' is not a finite number"},
      {header + "0,0,1,2x\n", "line 2: tip_rz_deg: '2x' is not a finite number"},
      {header + "0.5,0,1,2\n", "line 2: frame: '0.5' is not a whole number"},
      {header + "0,inf,1,2\n", "line 2: time_s: 'inf' is not a finite number"},
      {header + "0,0,1\n", "line 2: 3 fields under 4 columns"},
      {header + "0,0,1,2,3\n", "line 2: 5 fields under 4 columns"},
      {header + "4,0,1,2\n\n4,0,1,2\n", "line 4: frame 4 after frame 4"}};
  for (const auto& [text, message] : cases) {
    const auto table = read_poses(write(text), two_dofs());
    ASSERT_FALSE(table.ok()) << message;
    EXPECT_THAT(table.error().message, AllOf(HasSubstr(path_.string()), HasSubstr(message)));
  }
  EXPECT_THAT(read_poses("no/such.csv", two_dofs()).error().message, HasSubstr("no/such.csv: no such file"));
}

TEST_F(Tables, RefusesToWriteWhatIsNotAPose) {
  EXPECT_THROW((void)write_poses(path_, two_dofs(), {.rows = {{0, 0, {1}}}, .has_scores = false}),
               std::invalid_argument);
  EXPECT_THROW((void)write_poses(path_, two_dofs(), {.rows = {{0, 0, {1, NAN}}}, .has_scores = false}),
               std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Tables, WritesJointsWithPixelsHalfAPixelLess) {
  JointTable table{.rows = {{3, 0.1, "root", {0, 1, -2}, {320.5, 240.25}, {0.01, 0.02, 0.03}},
                            {3, 0.1, "head", {0, 1.5, -2}, {NAN, NAN}, {0, 0, 0}}},
                   .has_spread = true};
  ASSERT_TRUE(write_joints(path_, table).ok());
  EXPECT_EQ(read_text_file(path_).value(),
            "frame,time_s,joint,x_m,y_m,z_m,u_px,v_px,x_sd_m,y_sd_m,z_sd_m\n"
            "3,0.100000,root,0.000000,1.000000,-2.000000,320.000,239.750,0.010000,0.020000,0.030000\n"
            "3,0.100000,head,0.000000,1.500000,-2.000000,,,0.000000,0.000000,0.000000\n");
  const JointTable again = read_joints(path_).value();
  EXPECT_TRUE(again.has_spread);
  ASSERT_EQ(again.rows.size(), 2U);
  EXPECT_EQ(again.rows[0].joint, "root");
  EXPECT_TRUE(again.rows[0].x_in_world.isApprox(Eigen::Vector3d(0, 1, -2)));
  EXPECT_TRUE(again.rows[0].pixel.isApprox(Eigen::Vector2d(320.5, 240.25)));
  EXPECT_TRUE(again.rows[0].sd.isApprox(Eigen::Vector3d(0.01, 0.02, 0.03)));
  EXPECT_TRUE(std::isnan(again.rows[1].pixel.x()));
}

TEST_F(Tables, ATruthMayLackPixels) {
  const JointTable table =
      read_joints(write("frame,time_s,joint,x_m,y_m,z_m\n0,0,head,1,2,3\n1,0,head,1,2,3\n")).value();
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_FALSE(table.has_spread);
  EXPECT_TRUE(std::isnan(table.rows[0].pixel.x()));
}

TEST_F(Tables, NamesFileAndLineOfBadJoints) {
  const std::string header = "frame,time_s,joint,x_m,y_m,z_m,u_px,v_px\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"frame,time_s,x_m,y_m,z_m\n", "column 'joint' is missing"},
      {header + "0,0,,1,2,3,4,5\n", "line 2: no joint named"},
      {header + "0,0,a,1,nan,3,4,5\n", "line 2: y_m: 'nan' is not a finite number"},
      {header + "0,0,a,1,2,3,x,5\n", "line 2: u_px: 'x' is not a finite number"},
      {header + "0,0,a,1,2,3,4,5\n0,0,a,1,2,3,4,5\n", "line 3: joint 'a' twice in frame 0"},
      {header + "1,0,a,1,2,3,4,5\n0,0,a,1,2,3,4,5\n", "line 3: frame 0 after frame 1"}};
  for (const auto& [text, message] : cases) {
    const auto table = read_joints(write(text));
    ASSERT_FALSE(table.ok()) << message;
    EXPECT_THAT(table.error().message, AllOf(HasSubstr(path_.string()), HasSubstr(message)));
  }
}

}  // namespace
}  // namespace silpose
