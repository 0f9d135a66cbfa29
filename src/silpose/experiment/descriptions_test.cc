#include "silpose/experiment/descriptions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/option_error.h"
#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Descriptions : public FolderTest {
 protected:
  Descriptions() {
    describe("walk", "motion = \"02_01_walk.bvh\"");
    describe("sway", "motion = \"sway\"");
  }
  void describe(const std::string& name, const std::string& settings) {
    write_text_file(folder_ / (name + ".toml"),
                    "title = \"" + name + "\"\nseeds = 3\n[run]\n" + settings +
                        "\n[[axis]]\nname = \"view\"\nkey = \"view\"\nvalues = [\"front\"]\n"
                        "[[table]]\nname = \"errors\"\nfigures = [\"joint_error_mm\"]\n")
        .value();
  }
  GridChoice choice(std::vector<std::string> names) {
    return {.names = std::move(names), .folder = folder_, .data = {}, .seeds = {}};
  }
  std::string refusal(const GridChoice& choice) { return read_grids(choice).error().message; }
};

TEST_F(Descriptions, AreListedByName) {
  write_text_file(folder_ / "table.csv", "").value();
  EXPECT_THAT(all_descriptions(folder_), ElementsAre(folder_ / "sway.toml", folder_ / "walk.toml"));
  EXPECT_THAT(all_descriptions(folder_ / "absent"), ElementsAre());
}

TEST_F(Descriptions, AreFoundByNameOrPath) {
  GridChoice by_name = choice({"sway"}), by_path = choice({(folder_ / "sway.toml").string()});
  EXPECT_EQ(read_grids(by_name).value().at(0).name, "sway");
  EXPECT_EQ(read_grids(by_name).value().at(0).seeds, 3);
  by_path.seeds = 7;
  EXPECT_EQ(read_grids(by_path).value().at(0).seeds, 7);
  EXPECT_THAT(refusal(choice({"dance"})), HasSubstr("dance: no such experiment (sway, walk, all, or a .toml file)"));
  EXPECT_THROW((void)read_grids(choice({"sway", "sway"})), OptionError);
}

TEST_F(Descriptions, DataThatIsNotThereIsReportedBefore) {
  GridChoice all = choice({"all"});
  EXPECT_THAT(refusal(all), HasSubstr("walk: needs motion-capture files (02_01_walk.bvh and others)"));
  all.data = folder_;
  EXPECT_THAT(refusal(all), HasSubstr("02_01_walk.bvh: no such file"));
  write_text_file(folder_ / "02_01_walk.bvh", "").value();
  EXPECT_EQ(read_grids(all).value().size(), 2U);
}

}  // namespace
}  // namespace silpose
