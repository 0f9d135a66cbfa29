#include "silpose/track/open_questions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OpenQuestions : public testing::Test {
 protected:
  static const BodyModel& human() { return *human_for_test(); }
  // Two seconds at 20 per second, all angles known to one degree.
  std::vector<StepReport> reports() const {
    std::vector<StepReport> made(40);
    for (size_t t = 0; t < made.size(); ++t) {
      made[t].time_ns = static_cast<int64_t>(t) * 50'000'000;
      made[t].spread.assign(human().skeleton.dofs().size(), to_radians(1));
    }
    return made;
  }
  static size_t dof(const char* name) { return static_cast<size_t>(human().skeleton.find_dof(name).value()); }
};

TEST_F(OpenQuestions, NothingIsDoubtfulWhereAllIsKnown) {
  EXPECT_THAT(doubtful_angles(reports(), human()), IsEmpty());
  EXPECT_THAT(ambiguities(reports()), IsEmpty());
}

TEST_F(OpenQuestions, NamesTheJointAndTheTime) {
  std::vector<StepReport> some = reports();
  for (size_t t = 20; t <= 30; ++t) some[t].spread[dof("left_shin_rx")] = to_radians(20 + 0.1 * static_cast<double>(t));
  EXPECT_THAT(doubtful_angles(some, human()), ElementsAre("left_shin 1.0-1.5 s: within 38 degrees"));
}

TEST_F(OpenQuestions, LeavesOutWhatIsShortAndTwistsAndHands) {
  std::vector<StepReport> some = reports();
  some[10].spread[dof("left_shin_rx")] = 1;
  for (StepReport& report : some) report.spread[dof("left_thigh_ry")] = report.spread[dof("right_hand_rx")] = 1;
  EXPECT_THAT(doubtful_angles(some, human()), IsEmpty());
}

TEST_F(OpenQuestions, NamesEachKindOfAmbiguity) {
  std::vector<StepReport> some = reports();
  for (size_t t = 4; t <= 8; ++t) some[t].exchanged = 0.9;
  for (size_t t = 12; t < 14; ++t) some[t].turned = 0.3;
  some[20].crossed = some[30].crossed = 0.4;
  EXPECT_THAT(ambiguities(some), ElementsAre(HasSubstr("left for right in 5 frames (0.2-0.4 s)"),
                                             HasSubstr("front and back are ambiguous in 2 frames (0.6-0.7 s)"),
                                             HasSubstr("leg are ambiguous in 2 frames (1.0-1.0, 1.5-1.5 s)")));
}

}  // namespace
}  // namespace silpose
