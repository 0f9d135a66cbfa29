// Functions and files of the project are short; and the rule finds those that are not, in files made here.
#include "length_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_tree.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kProject = SILPOSE_SOURCE_DIR;

TEST(Project, HasShortFilesAndFunctions) {
  EXPECT_THAT(length_violations(kProject, {"src", "apps", "bench"}), IsEmpty());
}

class LengthRules : public SourceTree {
 protected:
  static std::string repeated(const std::string& line, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += line;
    return text;
  }
};

TEST_F(LengthRules, CountsAFunctionFromItsHeadToItsBrace) {
  write("src/a.cc", "namespace a {\n\n// Comment.\nint f(int x,\n      int y) {\n" + repeated("  ++x;\n", 7) +
                        "}\n\nint g() {\n" + repeated("  f(1, 2);\n", 8) + "}\n\n}  // namespace a\n");
  EXPECT_THAT(length_violations(root_, {"src"}, {.function = 10, .file = 100}), IsEmpty());
  EXPECT_THAT(length_violations(root_, {"src"}, {.function = 9, .file = 100}),
              ElementsAre("src/a.cc:4: 10 lines of 'int f(int x,', at most 9",
                          "src/a.cc:15: 10 lines of 'int g() {', at most 9"));
}

TEST_F(LengthRules, CountsMembersConstructorsAndTests) {
  write("bench/a.h", "class A {\n public:\n  A()\n      : a_(1),\n        b_(2) {\n" + repeated("    ++a_;\n", 3) +
                         "  }\n  struct B {\n    void f() const {\n" + repeated("      g();\n", 4) +
                         "    }\n  };\n};\n");
  write("bench/a_test.cc", "TEST(A, B) {\n" + repeated("  f();\n", 4) + "}\n");
  EXPECT_THAT(length_violations(root_, {"bench"}, {.function = 5, .file = 100}),
              ElementsAre(HasSubstr("bench/a.h:3: 7 lines of 'A()'"), HasSubstr("bench/a.h:11: 6 lines of 'void f()"),
                          HasSubstr("bench/a_test.cc:1: 6 lines of 'TEST(A, B) {'")));
}

// Classes, branches and tables are no functions; a lambda belongs to the function it is in.
TEST_F(LengthRules, CountsFunctionsOnly) {
  write("src/a.cc", "struct A {\n" + repeated("  int f(int);\n", 20) + "};\nconst int kTable[] = {\n" +
                        repeated("    f(1),\n", 20) + "};\nvoid g() {\n  if (f(1)) {\n    f(2);\n  }\n}\n");
  EXPECT_THAT(length_violations(root_, {"src"}, {.function = 8, .file = 100}), IsEmpty());
}

TEST_F(LengthRules, CountsLinesOfFiles) {
  write("src/a.cc", repeated("int a;\n", 5));
  write("src/b.md", repeated("text\n", 50));
  EXPECT_THAT(length_violations(root_, {"src"}, {.function = 60, .file = 5}), IsEmpty());
  EXPECT_THAT(length_violations(root_, {"src"}, {.function = 60, .file = 4}),
              ElementsAre("src/a.cc: 5 lines, at most 4"));
}

}  // namespace
}  // namespace silpose
