#include "silpose/likelihood/keypoint_term.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/seen_human_for_test.h"

namespace silpose {
namespace {

using KeypointTermTest = SeenHumanTest;

TEST_F(KeypointTermTest, DerivativeIsThatOfTheCost) {
  std::vector<double> pose = standing(0.4);
  Observation seen = see(pose, 3);
  add_keypoints(pose, seen);
  const KeypointTerm term(*body_, camera_, seen);
  EXPECT_EQ(term.num_directions(), 11u);
  for (size_t d = 0; d < pose.size(); ++d) pose[d] += 0.02 * static_cast<double>(d % 5);
  const Eigen::Index D = std::ssize(pose);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(D);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(D, D);
  EXPECT_NEAR(term.add(body_->skeleton, pose, 1, gradient, hessian), term.cost(body_->skeleton, pose), 1e-9);
  constexpr double kStep = 1e-6;
  for (size_t d = 0; d < pose.size(); ++d) {
    std::vector<double> more = pose, less = pose;
    more[d] += kStep, less[d] -= kStep;
    const double expected = (term.cost(body_->skeleton, more) - term.cost(body_->skeleton, less)) / (2 * kStep) /
                            2;  // add() gives that of half
    EXPECT_NEAR(gradient[static_cast<Eigen::Index>(d)], expected, 1e-3 * (1 + std::abs(expected))) << d;
  }
}

TEST_F(KeypointTermTest, FrontIsToldFromBackAndLeftFromRight) {
  const std::vector<double> truth = standing(0);
  const Observation seen = see(truth, 2);
  const KeypointTerm term(*body_, camera_, seen, {.places = 1});
  EXPECT_GT(term.cost(body_->skeleton, standing(kPi)), term.cost(body_->skeleton, truth) + 40);
}

TEST_F(KeypointTermTest, CountsOnlyWhatIsSeenAndTheBodyHas) {
  Observation seen = see(standing(0));
  const size_t all = KeypointTerm(*body_, camera_, seen).num_places();
  EXPECT_EQ(all, seen.keypoints_2d.size());
  seen.keypoints_2d[0].visibility = 0.2;
  seen.keypoints_2d[1].x = -3;
  seen.keypoints_2d[2].name = "tail";
  EXPECT_EQ(KeypointTerm(*body_, camera_, seen).num_places(), all - 3);
  seen.keypoints_2d.resize(8);
  EXPECT_FALSE(KeypointTerm(*body_, camera_, seen).determines_pose());
}

// A silhouette hardly changes when a forearm points at the camera instead of away from it; its direction does.
TEST_F(KeypointTermTest, DirectionsTellDepth) {
  std::vector<double> truth = standing(0.1), mirrored;
  const auto elbow = static_cast<size_t>(dof("left_forearm_rx")), arm = static_cast<size_t>(dof("left_upper_arm_rx"));
  truth[elbow] = 1.2;
  mirrored = truth;
  mirrored[arm] = -0.9, mirrored[elbow] = 0.4;
  Observation seen = see(truth);
  add_keypoints(truth, seen);
  const KeypointTerm places(*body_, camera_, seen, {.directions = 0, .places = 0.3}), both(*body_, camera_, seen);
  const auto worse = [&](const KeypointTerm& term) {
    return term.cost(body_->skeleton, mirrored) - term.cost(body_->skeleton, truth);
  };
  EXPECT_GT(worse(both), worse(places) + 10);
}

TEST_F(KeypointTermTest, DirectionsDoNotDependOnTheSizeOfTheBodyNorOnWhereItStands) {
  const std::vector<double> truth = standing(0.7);
  Observation seen = see(truth);
  add_keypoints(truth, seen);
  const KeypointTerm term(*body_, camera_, seen, {.places = 0});
  for (Keypoint3D& point : seen.keypoints_3d.points) {
    for (double& x : point.x) x *= 1.3;
  }
  const KeypointTerm larger(*body_, camera_, seen, {.places = 0});
  std::vector<double> elsewhere = truth;
  elsewhere[0] += 0.5, elsewhere[2] -= 1;
  EXPECT_NEAR(larger.cost(body_->skeleton, truth), term.cost(body_->skeleton, truth), 1e-9);
  EXPECT_NEAR(term.cost(body_->skeleton, elsewhere), term.cost(body_->skeleton, truth), 1e-9);
}

TEST_F(KeypointTermTest, AWildKeypointCostsLittleMoreThanABadOne) {
  const std::vector<double> truth = standing(0);
  Observation seen = see(truth);
  add_keypoints(truth, seen);
  const double good = KeypointTerm(*body_, camera_, seen).cost(body_->skeleton, truth);
  for (Keypoint3D& point : seen.keypoints_3d.points) {
    if (point.name == "left_hand") point.x[2] += 0.3;
  }
  const double bad = KeypointTerm(*body_, camera_, seen).cost(body_->skeleton, truth);
  for (Keypoint3D& point : seen.keypoints_3d.points) {
    if (point.name == "left_hand") point.x[2] += 30;
  }
  const double wild = KeypointTerm(*body_, camera_, seen).cost(body_->skeleton, truth);
  EXPECT_GT(bad, good + 2);
  EXPECT_LT(wild, good + 3 * (bad - good));
}

// The energy of both kinds of evidence is the sum of each by itself, and has the derivative of the sum; a camera
// without keypoints has silhouettes alone.
TEST_F(KeypointTermTest, BothKindsOfEvidenceAddUp) {
  const auto body = std::make_shared<const BodyModel>(level_of_detail(*body_, 1000));
  const std::vector<PinholeCamera> cameras = {camera_, camera_};
  const CoverageLikelihood likelihood(body, cameras);
  CoverageLikelihood::Scratch scratch(likelihood);
  std::vector<double> truth = standing(0.3), pose = truth;
  for (size_t d = 3; d < pose.size(); ++d) pose[d] += 0.05;
  Observation with = see(truth);
  add_keypoints(truth, with);
  Observation without = with;
  without.keypoints_2d.clear();
  without.keypoints_3d = {};
  const std::vector<Observation> seen = {with, without};
  const auto prepare = [&](EvidenceKind kind) { return likelihood.evidence_of(seen, Blur::k4, Blur::k4, kind); };
  const auto silhouettes = prepare(EvidenceKind::kSilhouette), keypoints = prepare(EvidenceKind::kKeypoints),
             both = prepare(EvidenceKind::kBoth);
  EXPECT_FALSE(silhouettes.has_directions());
  EXPECT_TRUE(both.has_directions());
  EXPECT_EQ(both.views[1].keypoints, nullptr);
  const double of_silhouettes = likelihood.energy(silhouettes, Blur::k4, pose, scratch),
               of_keypoints = KeypointTerm(*body_, camera_, with).cost(body->skeleton, pose),
               of_both = likelihood.energy(both, Blur::k4, pose, scratch);
  EXPECT_NEAR(of_both, of_silhouettes + of_keypoints, 1e-6 * of_both);
  // By themselves places weigh more.
  EXPECT_GT(likelihood.energy(keypoints, Blur::k4, pose, scratch), of_keypoints);
  const NormalEquations equations = likelihood.linearise(both, Blur::k4, pose, scratch);
  EXPECT_NEAR(equations.energy, of_both, 1e-6 * of_both);
  const NormalEquations outline = likelihood.linearise(silhouettes, Blur::k4, pose, scratch);
  Eigen::VectorXd gradient = outline.gradient;
  Eigen::MatrixXd hessian = outline.hessian;
  KeypointTerm(*body_, camera_, with).add(body->skeleton, pose, 1, gradient, hessian);
  EXPECT_LT((equations.gradient - gradient).norm(), 1e-9 * gradient.norm());
  EXPECT_LT((equations.hessian - hessian).norm(), 1e-9 * hessian.norm());
}

TEST_F(KeypointTermTest, PointsBehindTheCameraCostMoreThanAnyInTheImage) {
  const std::vector<double> truth = standing(0);
  Observation seen = see(truth);
  const KeypointTerm term(*body_, camera_, seen, {.directions = 0, .places = 1});
  std::vector<double> behind = truth, corner = truth;
  behind[2] += 20;
  corner[0] += 3;
  EXPECT_GT(term.cost(body_->skeleton, behind), term.cost(body_->skeleton, corner));
}

}  // namespace
}  // namespace silpose
