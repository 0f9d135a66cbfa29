#include "silpose/report/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "silpose/report/recording_for_test.h"

namespace silpose {
namespace {

using testing::HasSubstr;
using testing::Not;

nlohmann::json data_of(const std::string& page) {
  const std::string open = "id=\"data\">";
  const size_t start = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(start, page.find("</script>", start) - start));
}

class ReportPage : public testing::Test {
 protected:
  BodyModel body = arm_body();
  TrackRecording recording = three_frames();
  ReportInput input = {.title = "walk", .recording = &recording, .body = &body, .overlay_video = {}};
};

TEST_F(ReportPage, NeedsNoNetworkAndFillsEveryPlace) {
  input.warnings = {"nobody there"};
  input.facts = {{"Body", "human"}};
  input.stages_s = {{"decode", 1.5}};
  const std::string page = make_report(input).value();
  EXPECT_THAT(page, Not(HasSubstr("http:")));
  EXPECT_THAT(page, Not(HasSubstr("https:")));
  EXPECT_THAT(page, Not(HasSubstr("//cdn")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  for (const char* place : {"@TITLE@", "@HEADING@", "@VIDEO@", "@DATA@", "@STYLE@", "@SCRIPT@"}) {
    EXPECT_THAT(page, Not(HasSubstr(place)));
  }
  EXPECT_EQ(data_of(page)["warnings"][0], "nobody there");
  EXPECT_EQ(data_of(page)["stages"][0], (nlohmann::json{"decode", 1.5}));
}

TEST_F(ReportPage, KnowsNoJointButTheSkeletons) {
  const std::string page = make_report(input).value();
  for (const char* name : {"thigh", "shin", "elbow_", "thorax", "Right leg", "Right arm"}) {
    EXPECT_THAT(page, Not(HasSubstr(name)));
  }
}

TEST_F(ReportPage, HostileNamesStayText) {
  input.title = "<script>alert(1)</script>";
  input.facts = {{"Command", "</script><script>alert(2)</script>"}};
  const std::string page = make_report(input).value();
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(data_of(page)["facts"][0][1], "</script><script>alert(2)</script>");
}

TEST_F(ReportPage, WhatIsFilledInIsNotFilledInAgain) {
  input.title = "@DATA@";
  input.facts = {{"Command", "@VIDEO@ @TITLE@"}};
  const std::string page = make_report(input).value();
  EXPECT_THAT(page, HasSubstr("<title>@DATA@ - silpose</title>"));
  EXPECT_EQ(data_of(page)["facts"][0][1], "@VIDEO@ @TITLE@");
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
  EXPECT_EQ(data_of(make_report(input).value())["state"], "");
}

}  // namespace
}  // namespace silpose
