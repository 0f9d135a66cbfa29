#include "silpose/fit/initialisation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/rigs_for_test.h"
#include "silpose/body/test_body.h"
#include "silpose/fit/place_on_mask.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

class InitialisationTest : public ::testing::Test {
 protected:
  Observation see(const std::vector<double>& pose) const {
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    return observation;
  }
  std::vector<StartingPose> start(const std::vector<double>& truth, const StateBatch& candidates) const {
    const Observation seen = see(truth);
    return initialise(likelihood_, {body_, true}, {&seen, 1}, candidates);
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
  CoverageLikelihood likelihood_{body_, {camera_}};
};

TEST_F(InitialisationTest, PlacesTheBodyOnTheMask) {
  const std::vector<double> truth = {0.3, 0.55, -0.4, 0, 0, 0, 0, 0};
  const StateBatch placed = place_on_mask(*body_, camera_, see(truth), StateBatch::Zero(1, 8));
  EXPECT_NEAR(placed(0, 0), truth[0], 0.03);
  EXPECT_NEAR(placed(0, 1), truth[1], 0.03);
  EXPECT_NEAR(placed(0, 2), truth[2], 0.15);  // depth comes from size alone
}

TEST_F(InitialisationTest, PlacesABodyWhoseFirstDofsAreRotations) {
  const std::vector<double> truth = {0.3, 0.55, -0.4, 0, 0, 0, 0, 0};
  const BodyModel body = make_rotations_first_body();
  const StateBatch placed = place_on_mask(body, camera_, see(truth), StateBatch::Zero(1, 8));
  for (int d = 0; d < 5; ++d) EXPECT_EQ(placed(0, d), 0) << body.skeleton.dofs()[static_cast<size_t>(d)].name;
  EXPECT_NEAR(placed(0, 5), truth[2], 0.15);
  EXPECT_NEAR(placed(0, 6), truth[0], 0.03);
  EXPECT_NEAR(placed(0, 7), truth[1], 0.03);
}

TEST_F(InitialisationTest, LeavesABodyThatCannotMoveWhereItIs) {
  const StateBatch candidates = StateBatch::Constant(2, 8, 0.125);
  EXPECT_EQ(place_on_mask(make_chain_body(), camera_, see({0.3, 0.55, -0.4, 0, 0, 0, 0, 0}), candidates), candidates);
}

TEST_F(InitialisationTest, DescendsToABentPoseFromAStraightOne) {
  const std::vector<double> truth = {0.2, 0.5, 0.1, 0, 0, 0.5, 0, -0.6};
  const auto starts = start(truth, StateBatch::Zero(1, 8));
  // The tube is square: a quarter turn, bent the other way, looks the same. Some start is the truth, all fit.
  CoverageLikelihood::Scratch scratch(likelihood_);
  const Observation seen = see(truth);
  const auto evidence = likelihood_.evidence_of({&seen, 1});
  const double straight =
      likelihood_.energy(evidence, Blur::k4, std::vector<double>{0.2, 0.5, 0.1, 0, 0, 0, 0, 0}, scratch);
  EXPECT_LT(likelihood_.energy(evidence, Blur::k4, starts[0].pose, scratch), 0.1 * straight);
}

TEST_F(InitialisationTest, RanksTheBetterCandidateFirstAndKeepsOneOfEqualOnes) {
  const std::vector<double> truth = {0, 0.5, 0, 0, 0, 0.7, 0, 0};
  StateBatch candidates = StateBatch::Zero(3, 8);
  candidates(0, 5) = -0.7;
  candidates(1, 5) = candidates(2, 5) = 0.6;
  const auto starts = start(truth, candidates);
  // The one that bends the right way: a tube may also have turned its back and bend the other.
  EXPECT_LT((landmark_positions(*body_, starts[0].pose).back() - landmark_positions(*body_, truth).back()).norm(), 0.1);
  for (size_t i = 0; i < starts.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {  // the two that are equal are one
      EXPECT_GE(furthest_apart(landmark_positions(*body_, starts[i].pose), landmark_positions(*body_, starts[j].pose)),
                0.1);
    }
  }
  for (size_t i = 1; i < starts.size(); ++i) EXPECT_LE(starts[i].log_likelihood, starts[i - 1].log_likelihood);
}

TEST_F(InitialisationTest, TheBetterFacesTheCameraWhereNothingElseTells) {
  const std::vector<double> truth = {0, 0.5, 0, 0, 0, 0, 0, 0};
  StateBatch candidates = StateBatch::Zero(2, 8);
  candidates(0, 3) = -kPi;  // the back of a square tube looks just like its front, and very much like its sides
  const auto starts = start(truth, candidates);
  EXPECT_GT(std::cos(starts[0].pose[3]), -0.5);
}

}  // namespace
}  // namespace silpose
