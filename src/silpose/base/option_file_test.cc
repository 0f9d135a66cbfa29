#include "silpose/base/option_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class OptionFile : public FolderTest {
 protected:
  std::string write(const std::string& text) {
    const std::filesystem::path file = folder_ / "options.toml";
    write_text_file(file, text).value();
    return file.string();
  }
  std::vector<std::string> values(const std::string& text) {
    return read_option_file(write("value = " + text)).value().at(0).values;
  }
  std::string refusal(const std::string& text) { return read_option_file(write(text)).error().message; }
};

TEST_F(OptionFile, ReadsValuesAsACommandLineHasThem) {
  EXPECT_THAT(values("'magic'"), ElementsAre("magic"));
  EXPECT_THAT(values("3"), ElementsAre("3"));
  EXPECT_THAT(values("-0.25"), ElementsAre("-0.25"));
  EXPECT_THAT(values("true"), ElementsAre("true"));
  EXPECT_THAT(values("['1,2,3,4', 'a b', 5]"), ElementsAre("1,2,3,4", "a b", "5"));
  EXPECT_THAT(values("[]"), ElementsAre());
}

TEST_F(OptionFile, KeepsEveryDigitOfANumber) {
  EXPECT_EQ(std::stod(values("0.1").at(0)), 0.1);
  EXPECT_EQ(std::stod(values("1e-300").at(0)), 1e-300);
}

TEST_F(OptionFile, RefusalsNameTheFileAndTheKey) {
  EXPECT_THAT(refusal("start = "), HasSubstr("options.toml: line 1: "));
  EXPECT_THAT(refusal("start = 2000-01-01"), HasSubstr("options.toml: start: not a plain value"));
  EXPECT_THAT(refusal("[start]\na = 1"), HasSubstr("options.toml: start: not a plain value"));
  EXPECT_THAT(refusal("region = [[1]]"), HasSubstr("options.toml: region: not a list of plain values"));
  EXPECT_THAT(read_option_file(folder_ / "absent.toml").error().message, HasSubstr("absent.toml"));
}

TEST_F(OptionFile, WritesNumbersBareAndTextsInQuotes) {
  EXPECT_EQ(toml_value("true"), "true");
  EXPECT_EQ(toml_value("-1.5"), "-1.5");
  EXPECT_EQ(toml_value("0"), "0");
  for (const char* text : {"012", "5.", ".5", "1e3", "1,2", "nan", "", "human"}) {
    EXPECT_EQ(toml_value(text), std::string("'") + text + "'");
  }
  EXPECT_EQ(toml_list({"a", "1"}), "['a', 1]");
}

TEST_F(OptionFile, WhatIsWrittenIsReadAgain) {
  const std::vector<std::string> texts = {"it's", "C:\\clip", "1.50", "", "\u00e9\n", "true"};
  const std::filesystem::path file = folder_ / "config.toml";
  ASSERT_TRUE(
      write_option_file(file, "track", {{"model", toml_value("it's \"me\"")}, {"video", toml_list(texts)}}).ok());
  const std::vector<FileOption> read = read_option_file(file).value();
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].name, "model");
  EXPECT_THAT(read[0].values, ElementsAre("it's \"me\""));
  EXPECT_EQ(read[1].values.size(), texts.size());
  for (size_t i : {0, 1, 3, 4, 5}) EXPECT_EQ(read[1].values[i], texts[i]);
  EXPECT_EQ(read[1].values[2], "1.5") << "the same number";
  EXPECT_THAT(read_text_file(file).value(), HasSubstr("# Options of silpose track;"));
}

TEST_F(OptionFile, ReportsWhereItCannotBeWritten) {
  EXPECT_THAT(write_option_file(folder_ / "absent" / "config.toml", "track", {}).error().message,
              HasSubstr("config.toml"));
}

}  // namespace
}  // namespace silpose
