#include "silpose/base/text_file.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

using std::string_literals::operator""s;

TEST(TextFile, ReadsBackWhatWasWrittenAndLeavesNothingElse) {
  const auto directory = std::filesystem::path(testing::TempDir()) / "text_file_test";
  std::filesystem::remove_all(directory);
  std::filesystem::create_directories(directory);
  const std::string text = std::string(200000, 'x') + "\r\n\0end"s;
  ASSERT_TRUE(write_text_file(directory / "a.txt", "earlier").ok());
  ASSERT_TRUE(write_text_file(directory / "a.txt", text).ok());
  EXPECT_EQ(read_text_file(directory / "a.txt").value(), text);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory), {}), 1);
  std::filesystem::remove_all(directory);
}

TEST(TextFile, NamesWhatCannotBeReadOrWritten) {
  EXPECT_EQ(read_text_file("no/such.txt").error().message, "no/such.txt: no such file");
  EXPECT_EQ(read_text_file(testing::TempDir()).ok(), false);
  EXPECT_EQ(write_text_file("no/such/place.txt", "x").error().message, "no/such/place.txt: cannot be written");
}

}  // namespace
}  // namespace silpose
