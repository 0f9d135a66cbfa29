#include "silpose/synth/drawn_person.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(DrawPerson, KeepsTheStatureAndVariesTheBones) {
  const BodyModel body = make_test_body();
  double squared = 0;
  constexpr int kPeople = 60;
  const auto bone = [](const BodyModel& of) { return of.skeleton.joints()[2].offset_in_parent.norm(); };
  for (uint64_t seed = 1; seed <= kPeople; ++seed) {
    const BodyModel person = draw_person(body, seed);
    EXPECT_NEAR(person.height_m, body.height_m, 1e-6);
    EXPECT_EQ(person.skeleton.num_dofs(), body.skeleton.num_dofs());
    squared += std::pow(bone(person) / bone(body) - 1, 2) / kPeople;
  }
  EXPECT_GT(std::sqrt(squared), 0.02);
  EXPECT_LT(std::sqrt(squared), 0.06);
}

TEST(DrawPerson, TheSameSeedDrawsTheSamePerson) {
  const BodyModel body = make_test_body();
  EXPECT_EQ(draw_person(body, 3).rest.vertices, draw_person(body, 3).rest.vertices);
  EXPECT_NE(draw_person(body, 3).rest.vertices, draw_person(body, 4).rest.vertices);
}

}  // namespace
}  // namespace silpose
