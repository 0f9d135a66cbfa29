#include "silpose/track/initialisation.h"

#include <gtest/gtest.h>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

class InitialisationTest : public ::testing::Test {
 protected:
  Evidence see(const std::vector<double>& pose) const {
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    observation.box = observation.mask.bounding_box();
    return likelihood_.prepare({&observation, 1});
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
  SilhouetteLikelihood likelihood_{{std::make_shared<BatchRenderer>(body_, camera_)}, {}};
};

TEST_F(InitialisationTest, PlacesTheBodyOnTheMask) {
  const std::vector<double> truth = {0.3, 0.55, -0.4, 0, 0, 0, 0, 0};
  const StateBatch candidates = StateBatch::Zero(1, 8);
  const StateBatch placed = place_on_mask(likelihood_, see(truth), candidates);
  EXPECT_NEAR(placed(0, 0), truth[0], 0.03);
  EXPECT_NEAR(placed(0, 1), truth[1], 0.03);
  EXPECT_NEAR(placed(0, 2), truth[2], 0.15);  // depth comes from size alone
}

TEST_F(InitialisationTest, DescendsToABentPoseFromAStraightOne) {
  const std::vector<double> truth = {0.2, 0.5, 0.1, 0, 0, 0.5, 0, -0.6};
  const Evidence evidence = see(truth);
  const auto starts = initialise(likelihood_, evidence, StateBatch::Zero(1, 8));
  ASSERT_EQ(starts.size(), 1u);
  EXPECT_NEAR(starts[0].pose[5], truth[5], 0.15);
  EXPECT_NEAR(starts[0].pose[7], truth[7], 0.2);
  StateBatch state(1, 8);
  std::copy(starts[0].pose.begin(), starts[0].pose.end(), state.data());
  std::vector<double> distance(1);
  likelihood_.distances(evidence, state, distance);
  EXPECT_LT(distance[0], 0.08);
}

TEST_F(InitialisationTest, RanksTheBetterCandidateFirst) {
  const std::vector<double> truth = {0, 0.5, 0, 0, 0, 0.7, 0, 0};
  StateBatch candidates = StateBatch::Zero(2, 8);
  candidates(0, 5) = -0.7;
  candidates(1, 5) = 0.6;
  const auto starts = initialise(likelihood_, see(truth), candidates, {.num_iterations = 3, .num_layers = 2});
  ASSERT_EQ(starts.size(), 1u);  // both face the same way: the better one is left
  EXPECT_GT(starts[0].pose[5], 0);
}

TEST_F(InitialisationTest, KeepsADifferentHeadingAndPrefersTheOneThatFacesTheCamera) {
  const std::vector<double> truth = {0, 0.5, 0, 0, 0, 0.4, 0, 0};
  StateBatch candidates = StateBatch::Zero(2, 8);
  candidates(0, 3) = -kPi;  // the back of a bent tube looks just like its front
  candidates(0, 5) = -0.4;
  candidates(1, 5) = 0.4;
  const auto starts = initialise(likelihood_, see(truth), candidates, {.num_iterations = 3, .num_layers = 2});
  ASSERT_EQ(starts.size(), 2u);
  EXPECT_NEAR(starts[0].log_likelihood, starts[1].log_likelihood, 3);
  EXPECT_NEAR(starts[0].pose[3], 0, 0.5);
}

}  // namespace
}  // namespace silpose
