// The project itself obeys the rules; and the rules refuse what they should, on small trees made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_rules.h"
#include "source_tree.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const fs::path kProject = SILPOSE_SOURCE_DIR;

TEST(Project, IncludesOnlyLowerFloors) {
  EXPECT_THAT(include_violations(kProject, parse_floors(SILPOSE_FLOORS)), IsEmpty());
}
TEST(Project, HasNoCirclesBetweenUnits) { EXPECT_THAT(unit_circles(kProject), IsEmpty()); }
TEST(Project, HasNoFolderThatSaysNothing) { EXPECT_THAT(folder_violations(kProject), IsEmpty()); }
TEST(Project, CitesOnlyWhatTheBibliographyHolds) { EXPECT_THAT(citation_violations(kProject), IsEmpty()); }
TEST(Project, SaysWhereTunedConstantsComeFrom) {
  EXPECT_THAT(provenance_violations(
                  kProject, {"src/silpose/filter", "src/silpose/likelihood", "src/silpose/motion", "src/silpose/fit",
                             "src/silpose/offline", "src/silpose/segment", "src/silpose/track"}),
              IsEmpty());
}
TEST(Project, IsWrittenInTheTermsOfTheField) {
  const Phrases phrases = {
      {"anew", "again, from scratch"},
      {"of late", "recent"},
      {"of_late", "recent"},
      {"has a say", "counts"},
      {"have a say", "counts"},
      {"has_a_say", "is_usable"},
      {"sought", "searched"},
      {"go on from", "resume"},
      {"goes on from", "resumes"},
      {"going on from", "resuming"},
      {"gone on with", "resumed"},
      {"go on with", "resume"},
      {"afresh", "again"},
      {"taken up again", "resumed"},
      {"in vain", "without success"},
      {"in sight of", "known"},
      {"picture", "image"},
      {"pictures", "images"},
  };
  EXPECT_THAT(wording_violations(kProject, phrases), IsEmpty());
}

class SourceRules : public SourceTree {
 protected:
  Floors floors_ =
      parse_floors("base=0 geometry=1 image=1 filter=1 body=2 board=2 render=3 store=3 synth=4 recording=6");
};

TEST_F(SourceRules, LowerFloorsOwnModuleAndOtherLibrariesMayBeIncluded) {
  write("src/silpose/body/a.cc",
        "#include \"silpose/body/a.h\"\n#include \"silpose/geometry/b.h\"\n#include <vector>\n#include <Eigen/Core>\n");
  write("src/silpose/recording/a.h", "#include \"sadb/board/board.h\"\n");
  write("src/sadb/store/a.h", "#include \"sadb/board/board.h\"\n#include \"silpose/image/mask.h\"\n");
  write("src/silpose/silpose.h", "#include \"silpose/recording/a.h\"\n");
  EXPECT_THAT(include_violations(root_, floors_), IsEmpty());
}

TEST_F(SourceRules, RefusesTheSameAndHigherFloors) {
  write("src/silpose/geometry/a.cc", "// first\n#include \"silpose/image/mask.h\"\n");
  write("src/silpose/geometry/b.h", "  #  include <silpose/render/silhouette.h>\n");
  EXPECT_THAT(include_violations(root_, floors_),
              ElementsAre("src/silpose/geometry/a.cc:2: geometry (floor 1) includes image (floor 1)",
                          "src/silpose/geometry/b.h:1: geometry (floor 1) includes render (floor 3)"));
}

TEST_F(SourceRules, TestsAloneMayUseSynth) {
  const std::string text = "#include \"silpose/synth/scene.h\"\n";
  write("src/silpose/render/a_test.cc", text);
  EXPECT_THAT(include_violations(root_, floors_), IsEmpty());
  write("src/silpose/render/a.cc", text);
  write("src/silpose/body/b_test.cc", "#include \"silpose/render/a.h\"\n");
  EXPECT_EQ(include_violations(root_, floors_).size(), 2U);
}

TEST_F(SourceRules, KeepsSadbApart) {
  write("src/sadb/store/a.cc", "#include \"silpose/body/skeleton.h\"\n");
  write("src/silpose/synth/a.cc", "#include \"sadb/board/board.h\"\n");
  EXPECT_THAT(include_violations(root_, floors_),
              ElementsAre(HasSubstr("sadb sees only"), HasSubstr("does not see sadb")));
}

TEST_F(SourceRules, RefusesModulesWithoutAFloor) {
  write("src/silpose/body/a.cc", "#include \"silpose/magic/wand.h\"\n");
  EXPECT_THAT(include_violations(root_, floors_), ElementsAre(HasSubstr("'magic' has no floor")));
}

TEST_F(SourceRules, FindsCirclesBetweenUnits) {
  write("src/silpose/track/limbs.h", "");
  write("src/silpose/track/limbs.cc", "#include \"silpose/track/limbs.h\"\n#include \"silpose/track/limb_reach.h\"\n");
  write("src/silpose/track/limb_reach.h", "#include \"silpose/track/limbs.h\"\n");
  write("src/silpose/track/tracker.cc", "#include \"silpose/track/limbs.h\"\n");  // leads to a circle, is in none
  write("bench/c.h", "#include \"a.h\"\n");
  write("bench/a.h", "");
  write("bench/a-inl.h", "#  include <compare/b.h>\n");
  write("bench/compare/b.h", "");
  write("bench/compare/b.cc", "#include \"../c.h\"\n#include \"b.h\"\n");
  write("apps/silpose/x.h", "#include \"apps/silpose/y.h\"\n");
  write("apps/silpose/y.h", "#include \"apps/silpose/x.h\"\n#include \"apps/silpose/z.h\"\n");
  write("apps/silpose/z.h", "#include \"apps/silpose/y.h\"\n");
  EXPECT_THAT(unit_circles(root_), ElementsAre("apps/silpose: x -> y -> x", "bench: a -> compare/b -> c -> a",
                                               "src/silpose/track: limb_reach -> limbs -> limb_reach"));
}

TEST_F(SourceRules, UnitsMayDependOnOneAnotherOneWay) {
  write("src/sadb/board/entry.h", "#include \"sadb/board/time.h\"\n");
  write("src/sadb/board/time.h", "");
  write("src/sadb/board/time.cc", "#include \"sadb/board/time.h\"\n#include \"sadb/store/store.h\"\n");
  write("src/sadb/store/store.h", "#include \"sadb/board/entry.h\"\n");  // another module: the floors' matter
  EXPECT_THAT(unit_circles(root_), IsEmpty());
}

TEST_F(SourceRules, RefusesFoldersThatSayNothing) {
  write("src/silpose/util/a.h", "");
  write("apps/silpose/common/a.h", "");
  write("src/silpose/commonplace/a.h", "");
  EXPECT_THAT(folder_violations(root_), ElementsAre(HasSubstr("apps/silpose/common"), HasSubstr("src/silpose/util")));
}

TEST_F(SourceRules, RefusesCitationsThatDoNotResolve) {
  write("docs/references.bib", "@article{deutscher2005,\n title = {x}\n}\n@book{ opencv , }\n");
  write("src/silpose/body/a.h",
        "// Source: deutscher2005, eq. 3 (references.bib: opencv; deutscher2005 for the rest).\n"
        "int x2005 = 0xab2001;  // fine\n// See kalman1960a.\n// (references.bib: opencv, makehuman)\n");
  EXPECT_THAT(citation_violations(root_),
              ElementsAre("src/silpose/body/a.h:3: 'kalman1960a' is not in docs/references.bib",
                          "src/silpose/body/a.h:4: 'makehuman' is not in docs/references.bib"));
}

TEST_F(SourceRules, RefusesConstantsWithoutProvenance) {
  write("src/silpose/track/a.cc",
        "constexpr double kBare = 0.5;\n"
        "constexpr double kOwn = 0.5;  // [guess] metres\n"
        "constexpr int kNext = 3, kAfter = 4;  // tag of another line\n"
        "// A group. [tuned on rendered\n"
        "// clips]\n"
        "constexpr float kInGroup = 1.5f;\n"
        "constexpr int kAlsoInGroup[] = {1,\n"
        "                                2};\n"
        "\n"
        "constexpr int kAfterTheGroup = 7;\n"
        "// Another group.\n"
        "inline constexpr Table kTable[] = {{\"root_1\", x},\n"
        "                                   {\"b\", .5}};\n"
        "constexpr int kTagless = 2;  // guess [guessed] [tuned on ]\n");
  EXPECT_THAT(
      provenance_violations(root_, {"src/silpose/track"}),
      ElementsAre(HasSubstr("a.cc:1: kBare does not say"), HasSubstr("a.cc:3: kNext"),
                  HasSubstr("a.cc:10: kAfterTheGroup"), HasSubstr("a.cc:12: kTable"), HasSubstr("a.cc:14: kTagless")));
}

TEST_F(SourceRules, RefusesProvenanceThatDoesNotResolve) {
  write("docs/references.bib", "@article{deutscher2005,\n}\n");
  write("experiments/human-walk.toml", "");
  write("src/silpose/track/a.cc",
        "constexpr double kRight = 0.5;  // [paper: deutscher2005] [measured: experiment human-walk]\n"
        "constexpr double kNoPaper = 0.5;  // [paper: kalman1960]\n"
        "constexpr double kNoExperiment = 0.5;  // [measured: experiment human-run]\n"
        "constexpr double kNoName = 0.5;  // [measured: by hand]\n");
  EXPECT_THAT(provenance_violations(root_, {"src/silpose/track", "src/silpose/fit"}),
              ElementsAre("src/silpose/track/a.cc:2: 'kalman1960' is not in docs/references.bib",
                          "src/silpose/track/a.cc:3: there is no experiments/human-run.toml",
                          "src/silpose/track/a.cc:4: '[measured: by hand]' does not name an experiment",
                          "src/silpose/fit: there is no such folder"));
}

TEST_F(SourceRules, DerivedConstantsTextsAndLocalsNeedNoProvenance) {
  write("src/silpose/track/a.h",
        "constexpr int kReach = kTextureReach;\nconstexpr std::string_view kName = \"level 2\";\n"
        "constexpr double kInfinity = std::numeric_limits<double>::infinity();\nconstexpr Blur kBlur = Blur::k4;\n"
        "constexpr int words_of(int n) { return n / 64; }\nvoid f() {\n  constexpr int kLocal = 5;\n}\n");
  write("src/silpose/track/a_test.cc", "constexpr int kInTest = 5;\n");
  write("src/silpose/track/body_for_test.h", "constexpr int kForTest = 5;\n");
  write("src/silpose/render/a.cc", "constexpr int kElsewhere = 5;\n");
  EXPECT_THAT(provenance_violations(root_, {"src/silpose/track"}), IsEmpty());
}

TEST_F(SourceRules, FindsPhrasesAsWholeWordsInAnyCase) {
  write("src/silpose/track/a.cc", "// Utilise it.\nvoid re_utilise();\nvoid utilised();\n");
  write("README.md", "Runs.\nIt is able to run.\n");
  write("tests/layering/own.cc", "// utilise\n");
  EXPECT_THAT(wording_violations(root_, {{"utilise", "use"}, {"is able to", "can"}}),
              ElementsAre("src/silpose/track/a.cc:1: 'utilise': write: use",
                          "src/silpose/track/a.cc:2: 'utilise': write: use", "README.md:2: 'is able to': write: can"));
}

}  // namespace
}  // namespace silpose
