#include "silpose/session/body_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "silpose/base/folder_for_test.h"
#include "silpose/body/test_body.h"
#include "silpose/render/body_levels.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string refusal(const std::string& model) {
  const Result<void> fits = check_model(model);
  return fits ? "" : fits.error().message;
}

TEST(CheckModel, TakesHumansAndBodyFiles) {
  for (const char* model : {"human", "human:age=30,sex=f", "human:dof=37", "human:dof=37,age=30", "human:age=30,dof=37",
                            "absent.body", "folder/subject.body"}) {
    EXPECT_EQ(refusal(model), "") << model;
  }
}

TEST(CheckModel, SaysWhyNot) {
  EXPECT_THAT(refusal("centaur"), HasSubstr("centaur: unknown model"));
  EXPECT_THAT(refusal("humans"), HasSubstr("humans: unknown model"));
  EXPECT_THAT(refusal("human:wings=2"), HasSubstr("wings"));
  EXPECT_THAT(refusal("human:height=4"), HasSubstr("height"));
  EXPECT_THAT(refusal("human:dof=36,age=30"), HasSubstr("dof=36 is not supported"));
}

TEST(SizeDeviation, IsThatOfPeopleUnlessTheHeightIsKnown) {
  EXPECT_GT(size_deviation_of("human"), 0.02);
  EXPECT_GT(size_deviation_of("human:dof=37"), 0.02);
  EXPECT_EQ(size_deviation_of("human:height=1.7"), 0);
  EXPECT_EQ(size_deviation_of("absent.body"), 0);
}

class BodyChoice : public FolderTest {
 protected:
  RunContext context(const fs::path& data) {
    return {.data = data, .message = [this](const std::string& line) { told_.push_back(line); }};
  }
  std::vector<std::string> told_;
};

TEST_F(BodyChoice, LoadsABodyFileWithoutAWord) {
  const BodyModel tube = make_test_body();
  write_body(folder_ / "tube.body", tube).value();
  const auto body = choose_body((folder_ / "tube.body").string(), context(folder_)).value();
  EXPECT_EQ(body->name, tube.name);
  EXPECT_EQ(body->rest.vertices.size(), tube.rest.vertices.size());
  EXPECT_THAT(told_, IsEmpty());
  EXPECT_FALSE(choose_body((folder_ / "absent.body").string(), context(folder_)).ok());
}

TEST_F(BodyChoice, ErrorsNameTheModelOrWhatIsMissing) {
  EXPECT_THAT(choose_body("centaur", context(folder_)).error().message, HasSubstr("--model centaur: unknown model"));
  EXPECT_THAT(build_body("tube.body", context(folder_)).error().message, HasSubstr("unknown model"));
  EXPECT_THAT(choose_body("human", context(folder_)).error().message, HasSubstr("fetch-body-data"));
}

TEST_F(BodyChoice, TheModelOfAResultIsWhatItSays) {
  const auto say = [&](const char* text) { std::ofstream(folder_ / "run.json") << text; };
  EXPECT_EQ(model_of_result(folder_), "human");
  say(R"({"model": 5})");
  EXPECT_EQ(model_of_result(folder_), "human");
  say(R"({"model": "human:age=30"})");
  EXPECT_EQ(model_of_result(folder_), "human:age=30");
  write_body(folder_ / "fitted.body", make_test_body()).value();
  EXPECT_EQ(model_of_result(folder_), (folder_ / "fitted.body").string());
}

// Of the data that the other tests use, but for the bodies kept there.
TEST_F(BodyChoice, BuildsABodyOnceAndKeepsIt) {
  fs::create_directory_symlink(fs::path(SILPOSE_DATA_DIR) / "makehuman", folder_ / "makehuman");
  const std::string model = "human:height=1.8,dof=37";
  const auto built = choose_body(model, context(folder_)).value();
  EXPECT_THAT(told_, ElementsAre("building the body human:height=1.8", "building its levels of detail"));
  EXPECT_NEAR(built->height_m, 1.8, 1e-3);
  EXPECT_FALSE(built->levels.empty());

  told_.clear();
  const auto kept = choose_body(model, context(folder_)).value();
  EXPECT_THAT(told_, IsEmpty());
  EXPECT_EQ(kept->rest.vertices.size(), built->rest.vertices.size());
  EXPECT_EQ(kept->height_m, built->height_m);

  const fs::path file = folder_ / "bodies" / "human_height=1.8.body";
  EXPECT_TRUE(kept_human(file, folder_).has_value());
  fs::last_write_time(file, fs::file_time_type::min());
  EXPECT_FALSE(kept_human(file, folder_).has_value()) << "the program is newer";
  EXPECT_FALSE(kept_human(folder_ / "absent.body", folder_).has_value());
}

}  // namespace
}  // namespace silpose
