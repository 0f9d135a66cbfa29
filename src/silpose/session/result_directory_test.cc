#include "silpose/session/result_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "silpose/base/folder_for_test.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ResultDirectoryTest : public FolderTest {
 protected:
  void write(const fs::path& file, const std::string& text = "x") {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << text;
  }
  std::string read(const fs::path& file) {
    std::ifstream stream(folder_ / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write_result(const std::string& poses) {
    write("out/run.json", R"({"command": "silpose track"})");
    write("out/poses.csv", poses);
    write("out/masks/000001.png");
    write("out/masks_left/000001.png");
  }
  std::string refusal() {
    const auto made = ResultDirectory::create(folder_ / "out");
    return made ? "" : made.error().message;
  }
};

TEST_F(ResultDirectoryTest, TheEarlierResultIsReplacedOnlyWhenTheNewOneIsComplete) {
  write_result("earlier");
  {
    auto directory = ResultDirectory::create(folder_ / "out").value();
    write("out.partial/poses.csv", "new");
    EXPECT_EQ(read("out/poses.csv"), "earlier");
  }
  EXPECT_FALSE(fs::exists(folder_ / "out.partial")) << "the work failed";
  EXPECT_EQ(read("out/poses.csv"), "earlier");
  auto directory = ResultDirectory::create(folder_ / "out").value();
  write("out.partial/poses.csv", "new");
  write("out.partial/checkpoint.bin");
  write("out.partial/confidence/000001.png");
  ASSERT_TRUE(directory.commit().ok());
  EXPECT_EQ(read("out/poses.csv"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "out/run.json")) << "of the earlier one";
  EXPECT_FALSE(fs::exists(folder_ / "out/checkpoint.bin"));
  EXPECT_FALSE(fs::exists(folder_ / "out/confidence"));
  EXPECT_FALSE(fs::exists(folder_ / "out.partial"));
}

TEST_F(ResultDirectoryTest, WhatIsKeptIsThereForResuming) {
  {
    auto directory = ResultDirectory::create(folder_ / "out").value();
    write("out.partial/checkpoint.bin", "state");
    directory.keep();
  }
  {
    auto failing = ResultDirectory::create(folder_ / "out", true).value();
    EXPECT_EQ(read("out.partial/checkpoint.bin"), "state");
  }
  EXPECT_EQ(read("out.partial/checkpoint.bin"), "state") << "a failure loses nothing";
  auto fresh = ResultDirectory::create(folder_ / "out").value();
  EXPECT_FALSE(fs::exists(folder_ / "out.partial/checkpoint.bin")) << "without resuming it starts empty";
}

TEST_F(ResultDirectoryTest, ForeignFilesAreNeverTouched) {
  EXPECT_EQ(refusal(), "");
  write_result("earlier");
  EXPECT_EQ(refusal(), "");
  write("out/thesis.pdf");
  EXPECT_THAT(refusal(), HasSubstr("thesis.pdf"));
  fs::remove(folder_ / "out/thesis.pdf");
  write("out/masks/holiday.png");
  EXPECT_THAT(refusal(), HasSubstr("masks"));
  fs::remove(folder_ / "out/masks/holiday.png");
  write("out/run.json", R"({"command": "other"})");
  EXPECT_THAT(refusal(), HasSubstr("no run.json of silpose"));
  fs::remove_all(folder_ / "out");
  write("out");
  EXPECT_THAT(refusal(), HasSubstr("exists and is not a directory"));
  fs::remove(folder_ / "out");
  write("out.partial/notes.txt");
  EXPECT_THAT(refusal(), HasSubstr("notes.txt"));
  EXPECT_TRUE(fs::exists(folder_ / "out.partial/notes.txt"));
}

}  // namespace
}  // namespace silpose
