#include "silpose/base/checked_file.h"

#include <gmock/gmock.h>

#include <fstream>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using testing::HasSubstr;

constexpr FileKind kKind{.magic = "SILPTEST", .version = 3, .name = "test file"};

class CheckedFile : public testing::Test {
 protected:
  ~CheckedFile() override { std::filesystem::remove(path_); }
  std::string failure_of(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    const Result<std::string> read = read_checked_file(path_, kKind);
    return read ? "" : read.error().message;
  }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() /
      (std::string("silpose_checked_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(CheckedFile, ComesBackAsItWas) {
  for (const std::string& payload : {std::string(), std::string("a\0b", 3)}) {
    ASSERT_TRUE(write_checked_file(path_, kKind, payload));
    EXPECT_EQ(read_checked_file(path_, kKind).value(), payload);
  }
}

TEST_F(CheckedFile, SaysWhatIsWrong) {
  ASSERT_TRUE(write_checked_file(path_, kKind, "some payload"));
  const std::string good = read_text_file(path_).value();
  EXPECT_THAT(failure_of(""), HasSubstr("empty"));
  EXPECT_THAT(failure_of("a text"), HasSubstr("not a test file"));
  for (size_t size = 8; size < good.size(); ++size)
    EXPECT_THAT(failure_of(good.substr(0, size)), HasSubstr("truncated"));
  EXPECT_THAT(failure_of(good + "x"), HasSubstr("damaged"));
  std::string flipped = good;
  flipped.back() ^= 1;
  EXPECT_THAT(failure_of(flipped), HasSubstr("damaged"));
  std::string newer = good;
  newer[8] = 4;
  EXPECT_THAT(failure_of(newer), HasSubstr("version 4, not 3"));
  EXPECT_THAT(failure_of(newer), HasSubstr(path_.string()));
}

}  // namespace
}  // namespace silpose
