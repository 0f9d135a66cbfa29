#include "silpose/report/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace silpose {
namespace {

using testing::HasSubstr;
using testing::Not;

Skeleton arm() {
  Joint root{.name = "root", .dof_indices = {0, 1}};
  Joint elbow{.name = "elbow", .parent_idx = 0, .offset_in_parent = {0, -0.3, 0}, .dof_indices = {2}};
  Dof move{.name = "root_tx", .is_translation = true, .lower = -1, .upper = 1};
  Dof turn{.name = "root_rx", .is_periodic = true, .lower = -kPi, .upper = kPi};
  Dof bend{.name = "right_forearm_rx", .joint_idx = 1, .lower = 0, .upper = kPi / 2};
  return Skeleton("arm", {root, elbow}, {move, turn, bend});
}

TrackRecording three_frames() {
  TrackRecording recording;
  recording.skeleton = "arm";
  recording.steps.push_back({.frame_idx = 60, .time_ns = 2'000'000'000});
  recording.steps.push_back({.frame_idx = 61,
                             .time_ns = 2'033'333'333,
                             .state = StepReport::State::kTracked,
                             .pose = {0.5, 0, kPi / 6},
                             .spread = {0.01, 0, kPi / 180},
                             .visual_accuracy = 0.875,
                             .effective_sample_size = 100});
  recording.steps.push_back({.frame_idx = 62,
                             .time_ns = 2'066'666'667,
                             .state = StepReport::State::kCoasted,
                             .pose = {0.5, 0, kPi / 6},
                             .spread = {0.02, 0, kPi / 90}});
  return recording;
}

nlohmann::json data_of(const std::string& page) {
  const std::string open = "id=\"data\">";
  const size_t start = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(start, page.find("</script>", start) - start));
}

class ReportPage : public testing::Test {
 protected:
  Skeleton skeleton = arm();
  TrackRecording recording = three_frames();
  ReportInput input = {.title = "walk", .recording = &recording, .skeleton = &skeleton, .overlay_video = {}};
};

TEST_F(ReportPage, ShowsDegreesMetresAndGaps) {
  const nlohmann::json data = data_of(make_report(input).value());
  EXPECT_EQ(data["frame"], (nlohmann::json{60, 61, 62}));
  EXPECT_EQ(data["state"], (nlohmann::json{"waiting", "tracked", "coasted"}));
  EXPECT_EQ(data["accuracy"], (nlohmann::json{nullptr, 0.875, nullptr}));
  EXPECT_EQ(data["dofs"][0]["values"], (nlohmann::json{nullptr, 0.5, 0.5}));
  EXPECT_EQ(data["dofs"][0]["unit"], "m");
  EXPECT_EQ(data["dofs"][2]["values"], (nlohmann::json{nullptr, 30.0, 30.0}));
  EXPECT_EQ(data["dofs"][2]["sd"], (nlohmann::json{nullptr, 1.0, 2.0}));
  EXPECT_EQ(data["dofs"][2]["limits"], (nlohmann::json{0.0, 90.0}));
  EXPECT_EQ(data["dofs"][2]["part"], "Right arm");
  EXPECT_TRUE(data["dofs"][1]["limits"].is_null());
}

TEST_F(ReportPage, NeedsNoNetworkAndFillsEveryPlace) {
  input.warnings = {"nobody there"};
  input.facts = {{"Body", "human"}};
  input.stages_s = {{"decode", 1.5}};
  const std::string page = make_report(input).value();
  EXPECT_THAT(page, Not(HasSubstr("http:")));
  EXPECT_THAT(page, Not(HasSubstr("https:")));
  for (const char* place : {"@TITLE@", "@VIDEO@", "@DATA@"}) EXPECT_THAT(page, Not(HasSubstr(place)));
  EXPECT_EQ(data_of(page)["warnings"][0], "nobody there");
  EXPECT_EQ(data_of(page)["stages"][0], (nlohmann::json{"decode", 1.5}));
}

TEST_F(ReportPage, HostileNamesStayText) {
  input.title = "<script>alert(1)</script>";
  input.facts = {{"Command", "</script><script>alert(2)</script>"}};
  const std::string page = make_report(input).value();
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(data_of(page)["facts"][0][1], "</script><script>alert(2)</script>");
}

TEST_F(ReportPage, EmbedsASmallVideoAndLinksALargeOne) {
  input.overlay_video = std::filesystem::path(testing::TempDir()) / "silpose_report_overlay.mp4";
  for (const auto& [bytes, text] :
       {std::pair<std::string, std::string>{"M", "TQ=="}, {"Ma", "TWE="}, {"Man", "TWFu"}}) {
    std::ofstream(input.overlay_video, std::ios::binary) << bytes;
    EXPECT_THAT(make_report(input).value(), HasSubstr("src=\"data:video/mp4;base64," + text + "\""));
  }
  input.embed_limit_bytes = 2;
  EXPECT_THAT(make_report(input).value(), HasSubstr("src=\"silpose_report_overlay.mp4\""));
  std::filesystem::remove(input.overlay_video);
  EXPECT_THAT(make_report(input).error().message, HasSubstr("silpose_report_overlay.mp4"));
}

TEST_F(ReportPage, AnEmptyRecordingIsAPage) {
  recording.steps.clear();
  EXPECT_TRUE(data_of(make_report(input).value())["frame"].empty());
}

}  // namespace
}  // namespace silpose
