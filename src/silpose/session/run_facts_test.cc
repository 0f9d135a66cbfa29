#include "silpose/session/run_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/text_file.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

TEST(RunFacts, BeginWithTheProgram) {
  const Json facts = run_facts({.version = "1.2", .command_line = "silpose track a.mp4", .seed = 7});
  EXPECT_EQ(facts.begin().key(), "version");
  EXPECT_EQ(facts["command"], "silpose track a.mp4");
  EXPECT_EQ(facts["seed"], 7);
  EXPECT_EQ(facts["machine"], machine_name());
}

TEST(RunFacts, FiguresAreNullWhereNothingIsKnown) {
  EXPECT_EQ(figure(1.5, 0.25).dump(), R"({"mean":1.5,"std":0.25})");
  EXPECT_TRUE(figure(std::numeric_limits<double>::quiet_NaN(), 0).is_null());
}

TEST(RunFacts, FocalLengthsAreInPixels) {
  const Json focal = facts_of(FocalSource{{.focal_px = 480, .deviation = 0.25}, "metadata"});
  EXPECT_EQ(focal.dump(), R"({"mean":480.0,"std":120.0,"from":"metadata"})");
}

TEST(RunFacts, OfABodySayWhatWasFittedAlone) {
  BodyFit fit;
  EXPECT_TRUE(facts_of(fit).is_null());
  fit.size = SizeFit{.factor = 1.05, .deviation = 0.01};
  fit.names = {"right_shin_length"};
  fit.lengths = {0.02};
  fit.deviations = {0.005};
  const Json facts = facts_of(fit);
  EXPECT_EQ(facts["size"]["mean"], 1.05);
  EXPECT_EQ(facts["lengths_m"]["right_shin_length"]["std"], 0.005);
  EXPECT_FALSE(facts.contains("girths"));
}

using FinishResult = FolderTest;

TEST_F(FinishResult, WritesFactsAndOptionsAndRenames) {
  const fs::path out = folder_ / "out";
  ResultDirectory directory = ResultDirectory::create(out).value();
  ASSERT_TRUE(finish_result(directory, "track", {{"grow", "1"}}, {{"command", "silpose track"}}, false).ok());
  EXPECT_TRUE(is_whole_result(out));
  EXPECT_THAT(read_text_file(out / "config.toml").value(), HasSubstr("track; give this file to --config.\ngrow = 1\n"));
}

TEST_F(FinishResult, KeepsWhatIsInterruptedUnderItsPartialName) {
  const fs::path out = folder_ / "out", partial = folder_ / "out.partial";
  {
    ResultDirectory directory = ResultDirectory::create(out).value();
    ASSERT_TRUE(finish_result(directory, "track", {}, {{"command", "silpose track"}}, true).ok());
  }
  EXPECT_FALSE(fs::exists(out));
  EXPECT_TRUE(fs::exists(partial / "run.json"));
}

}  // namespace
}  // namespace silpose
