#include "silpose/fit/pose_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

constexpr FitStage kTrackingStages[] = {{Blur::k8, 4}, {Blur::k4, 3}, {Blur::k2, 3}};
constexpr FitStage kStartStages[] = {{Blur::k32, 4}, {Blur::k16, 5}, {Blur::k8, 5}, {Blur::k4, 4}};

class PoseFitTest : public ::testing::Test {
 protected:
  CoverageEvidence see(const std::vector<double>& pose) const {
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    return likelihood_.evidence_of({&observation, 1});
  }
  static Eigen::VectorXd vector_of(const std::vector<double>& pose) {
    return Eigen::Map<const Eigen::VectorXd>(pose.data(), std::ssize(pose));
  }
  GaussianPrior prior(const std::vector<double>& mean, double deviation) const {
    return {vector_of(mean), Eigen::MatrixXd::Identity(8, 8) / (deviation * deviation)};
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
  CoverageLikelihood likelihood_{body_, {camera_}};
  PosePrior pose_prior_{body_, true};
};

TEST_F(PoseFitTest, ClimbsToTheTruthFromAfar) {
  const std::vector<double> truth = {0.3, 0.5, 0, 0, 0, 0.5, 0, -0.4}, start = {0, 0.6, 0, 0, 0, 0, 0, 0};
  CoverageLikelihood::Scratch scratch(likelihood_);
  const PoseFit fit =
      fit_pose(likelihood_, pose_prior_, see(truth), prior(start, 0.5), vector_of(start), kStartStages, {}, scratch);
  EXPECT_NEAR(fit.pose[0], truth[0], 0.02);
  EXPECT_NEAR(fit.pose[1], truth[1], 0.02);
  EXPECT_NEAR(fit.pose[7] + fit.pose[5], truth[7] + truth[5], 0.15);
}

TEST_F(PoseFitTest, AStrongPriorHolds) {
  const std::vector<double> truth = {0.3, 0.5, 0, 0, 0, 0.5, 0, 0}, mean = {0, 0.5, 0, 0, 0, 0, 0, 0};
  CoverageLikelihood::Scratch scratch(likelihood_);
  const PoseFit fit =
      fit_pose(likelihood_, pose_prior_, see(truth), prior(mean, 1e-5), vector_of(mean), kTrackingStages, {}, scratch);
  EXPECT_LT((fit.pose - vector_of(mean)).cwiseAbs().maxCoeff(), 1e-3);
}

TEST_F(PoseFitTest, StaysInsideTheLimits) {
  // The tube bends by at most its limits: a mask bent further pulls against them.
  const auto dofs = body_->skeleton.dofs();
  std::vector<double> truth = {0, 0.5, 0, 0, 0, 0, 0, 0};
  truth[5] = dofs[5].upper + 0.4;
  CoverageLikelihood::Scratch scratch(likelihood_);
  const PoseFit fit =
      fit_pose(likelihood_, pose_prior_, see(truth), prior(std::vector<double>{0, 0.5, 0, 0, 0, 0, 0, 0}, 2),
               vector_of({0, 0.5, 0, 0, 0, 0.3, 0, 0}), kTrackingStages, {}, scratch);
  for (int d = 4; d < 8; ++d) {
    EXPECT_GE(fit.pose[d], dofs[static_cast<size_t>(d)].lower);
    EXPECT_LE(fit.pose[d], dofs[static_cast<size_t>(d)].upper);
  }
}

TEST_F(PoseFitTest, NothingInTheImageLeavesThePrior) {
  std::vector<double> away = {0, 0.5, 40, 0, 0, 0, 0, 0};  // behind the camera
  CoverageLikelihood::Scratch scratch(likelihood_);
  const PoseFit fit = fit_pose(likelihood_, pose_prior_, see({0, 0.5, 0, 0, 0, 0, 0, 0}), prior(away, 0.1),
                               vector_of(away), kTrackingStages, {}, scratch);
  EXPECT_TRUE(fit.pose.isApprox(vector_of(away), 1e-9));
}

}  // namespace
}  // namespace silpose
