// The contract of PoseLikelihood, for every likelihood there is; a new one is one line at the end.
#include "silpose/likelihood/pose_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/depth_likelihood.h"
#include "silpose/likelihood/keypoint_likelihood.h"
#include "silpose/likelihood/seen_human_for_test.h"
#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/likelihood/sum_likelihood.h"
#include "silpose/render/shaded.h"

namespace silpose {
namespace {

using Body = std::shared_ptr<const BodyModel>;
using Cameras = std::vector<PinholeCamera>;
using Made = std::shared_ptr<const PoseLikelihood>;

struct Case {
  std::string name;
  std::function<Made(const Body&, const Cameras&)> make;
};

std::vector<std::shared_ptr<const RenderBackend>> backends(const Body& body, const Cameras& cameras,
                                                           const MakeRenderBackend& make = make_cpu_backend) {
  std::vector<std::shared_ptr<const RenderBackend>> made;
  for (const PinholeCamera& camera : cameras) made.push_back(make(body, camera));
  return made;
}

Made silhouettes(const Body& body, const Cameras& cameras, AreaMetric::Unit unit,
                 const MakeRenderBackend& make = make_cpu_backend) {
  return std::make_shared<SilhouetteLikelihood>(backends(body, cameras, make), std::make_shared<AreaMetric>(unit),
                                                SilhouetteOptions{});
}
Made pixels(const Body& body, const Cameras& cameras) { return silhouettes(body, cameras, AreaMetric::Unit::kPixels); }
Made keypoints(const Body& body, const Cameras& cameras) {
  return std::make_shared<KeypointLikelihood>(body, cameras, KeypointOptions{});
}
Made depths(const Body& body, const Cameras& cameras) {
  return std::make_shared<DepthLikelihood>(backends(body, cameras), DepthOptions{});
}
Made coverage(const Body& body, const Cameras& cameras) { return std::make_shared<CoverageLikelihood>(body, cameras); }

class PoseLikelihoodContract : public SeenHumanTest, public testing::WithParamInterface<Case> {
 protected:
  PoseLikelihoodContract() {
    body_ = human_for_test(800);
    for (int c = 0; c < 2; ++c) {
      const double angle = 0.4 + 1.4 * c;
      cameras_.push_back(
          look_at_camera(320, 240, 300, {3.5 * std::sin(angle), 1.2, 3.5 * std::cos(angle)}, {0, 0.9, 0}));
    }
    truth_ = standing(0.3);
    truth_[static_cast<size_t>(dof("left_thigh_rx"))] = 0.6;
    truth_[static_cast<size_t>(dof("right_upper_arm_rz"))] = 0.8;
    likelihood_ = GetParam().make(body_, cameras_);
    for (const PinholeCamera& camera : cameras_) observations_.push_back(observe(camera));
  }

  Observation observe(const PinholeCamera& camera) {
    camera_ = camera;
    Observation seen = see(truth_);
    add_keypoints(truth_, seen);
    const Image<float> depth = draw_depth(camera, skin_vertices(*body_, truth_), body_->rest.faces);
    DepthImage measured(camera.width, camera.height);
    for (size_t i = 0; i < depth.pixels().size(); ++i) {
      measured.pixels()[i] = static_cast<uint16_t>(std::lround(1000 * depth.pixels()[i]));
    }
    seen.mask = render_silhouette(*body_, camera, truth_);
    seen.depth = std::make_shared<const DepthImage>(std::move(measured));
    return seen;
  }
  std::vector<double> off(const char* name, double by) const {
    std::vector<double> pose = truth_;
    pose[static_cast<size_t>(dof(name))] += by;
    return pose;
  }
  static StateBatch batch(const std::vector<std::vector<double>>& poses) {
    StateBatch states(std::ssize(poses), std::ssize(poses.front()));
    for (Eigen::Index n = 0; n < states.rows(); ++n) {
      const auto& pose = poses[static_cast<size_t>(n)];
      states.row(n) = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), std::ssize(pose));
    }
    return states;
  }
  std::vector<double> values(const StateBatch& states) const { return values(states, observations_); }
  std::vector<double> values(const StateBatch& states, const std::vector<Observation>& seen) const {
    std::vector<double> out(static_cast<size_t>(states.rows()), 0.0);
    likelihood_->add_log_likelihood(*likelihood_->prepare(seen), states, out);
    return out;
  }

  Cameras cameras_;
  std::vector<double> truth_;
  Made likelihood_;
  std::vector<Observation> observations_;
};

TEST_P(PoseLikelihoodContract, FallsWithTheDistanceFromTheTruth) {
  for (const char* name : {"root_tx", "root_ty", "root_ry", "left_thigh_rx", "right_upper_arm_rz"}) {
    for (const double sign : {-1.0, 1.0}) {
      const auto found = values(batch({truth_, off(name, 0.15 * sign), off(name, 0.4 * sign)}));
      EXPECT_GT(found[0], found[1]) << name << " " << sign;
      EXPECT_GT(found[1], found[2]) << name << " " << sign;
    }
  }
}

TEST_P(PoseLikelihoodContract, AddsToWhatIsThere) {
  const auto found = values(batch({truth_, off("root_tx", 0.2)}));
  std::vector<double> out = {3, -5};
  likelihood_->add_log_likelihood(*likelihood_->prepare(observations_), batch({truth_, off("root_tx", 0.2)}), out);
  EXPECT_NEAR(out[0], found[0] + 3, 1e-9);
  EXPECT_NEAR(out[1], found[1] - 5, 1e-9 * std::abs(found[1]));
}

TEST_P(PoseLikelihoodContract, NeitherTheBatchNorThreadsNorFurtherColumnsChangeAValue) {
  std::vector<std::vector<double>> poses;
  for (int i = 0; i < 30; ++i) poses.push_back(off("left_thigh_rx", 0.02 * i));
  const auto forward = values(batch(poses));
  std::ranges::reverse(poses);
  auto backward = values(batch(poses));
  std::ranges::reverse(backward);
  EXPECT_EQ(forward, backward);
  for (auto& pose : poses) pose.resize(2 * pose.size(), std::numeric_limits<double>::quiet_NaN());
  const ThreadLimit limit(1);
  auto wide = values(batch(poses));
  std::ranges::reverse(wide);
  EXPECT_EQ(forward, wide);
}

TEST_P(PoseLikelihoodContract, CamerasAddUpAndTrustScales) {
  const StateBatch states = batch({off("root_tx", 0.2)});
  const double both = values(states)[0];
  double sum = 0;
  for (size_t c = 0; c < 2; ++c) {
    std::vector<Observation> one = observations_;
    one[1 - c] = Observation{Mask(320, 240)};
    one[1 - c].trust = {.overall = 0, .nothing_found = true};
    sum += values(states, one)[0];
  }
  EXPECT_NEAR(sum, both, 1e-9 * std::abs(both));
  std::vector<Observation> doubtful = observations_;
  for (Observation& seen : doubtful) seen.trust.overall = 0.5;
  EXPECT_NEAR(values(states, doubtful)[0], both / 2, 1e-9 * std::abs(both));
}

TEST_P(PoseLikelihoodContract, WhatFoundNothingAddsNothing) {
  Observation nothing{Mask(320, 240)};
  nothing.trust = {.overall = 0, .nothing_found = true};
  EXPECT_EQ(values(batch({truth_}), {nothing, nothing}), std::vector<double>{0});
}

TEST_P(PoseLikelihoodContract, TheLinearisationIsItsDerivative) {
  if (!likelihood_->can_linearise()) {
    const auto evidence = likelihood_->prepare(observations_);
    EXPECT_THROW((void)likelihood_->linearise(*evidence, truth_), std::logic_error);
    return;
  }
  const std::vector<double> pose = off("left_thigh_rx", 0.1);
  const auto evidence = likelihood_->prepare(observations_);
  const NormalEquations equations = likelihood_->linearise(*evidence, pose);
  EXPECT_NEAR(equations.energy, -2 * values(batch({pose}))[0], 1e-6 * equations.energy);
  EXPECT_LT((equations.hessian - equations.hessian.transpose()).norm(), 1e-9 * equations.hessian.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(equations.hessian);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-9 * eigen.eigenvalues().maxCoeff());
  constexpr double kStep = 2e-3;
  Eigen::VectorXd numeric(equations.gradient.size());
  for (Eigen::Index d = 0; d < numeric.size(); ++d) {
    std::vector<double> more = pose, less = pose;
    more[static_cast<size_t>(d)] += kStep, less[static_cast<size_t>(d)] -= kStep;
    const auto found = values(batch({more, less}));
    numeric[d] = -2 * (found[0] - found[1]) / (4 * kStep);
  }
  EXPECT_LT((numeric - equations.gradient).norm(), 0.1 * numeric.norm());  // coverage is sampled in rows
}

TEST_P(PoseLikelihoodContract, RefusesWrongShapesAndForeignEvidence) {
  const auto evidence = likelihood_->prepare(observations_);
  std::vector<double> two(2);
  EXPECT_THROW(likelihood_->add_log_likelihood(*evidence, batch({truth_}), two), std::invalid_argument);
  EXPECT_THROW(likelihood_->add_log_likelihood(*evidence, StateBatch::Zero(2, 3), two), std::invalid_argument);
  EXPECT_THROW((void)likelihood_->prepare({}), std::invalid_argument);
  std::vector<Observation> small = observations_;
  small[1].mask = Mask(32, 24);
  EXPECT_THROW((void)likelihood_->prepare(small), std::invalid_argument);
  std::vector<Observation> shallow = observations_;
  shallow[0].depth = std::make_shared<const DepthImage>(8, 8);
  EXPECT_THROW((void)likelihood_->prepare(shallow), std::invalid_argument);
  struct Foreign : PoseLikelihood::Evidence {};
  std::vector<double> one(1);
  EXPECT_THROW(likelihood_->add_log_likelihood(Foreign(), batch({truth_}), one), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(
    All, PoseLikelihoodContract,
    testing::Values(Case{"PixelCount", pixels},
                    Case{"Coverage",
                         [](const Body& body, const Cameras& cameras) {
                           return silhouettes(body, cameras, AreaMetric::Unit::kSamples);
                         }},
                    Case{"DrawnByTheReference",
                         [](const Body& body, const Cameras& cameras) {
                           return silhouettes(body, cameras, AreaMetric::Unit::kPixels, make_reference_backend);
                         }},
                    Case{"BlurredCoverage", coverage}, Case{"Keypoints", keypoints}, Case{"Depth", depths},
                    Case{"SumOfSampled",
                         [](const Body& body, const Cameras& cameras) -> Made {
                           return std::make_shared<SumLikelihood>(std::vector<Made>{
                               pixels(body, cameras), keypoints(body, cameras), depths(body, cameras)});
                         }},
                    Case{"SumOfFitted",
                         [](const Body& body, const Cameras& cameras) -> Made {
                           return std::make_shared<SumLikelihood>(
                               std::vector<Made>{coverage(body, cameras), keypoints(body, cameras)});
                         }}),
    [](const auto& tested) { return tested.param.name; });

// A term of the coverage likelihood counts as in a sum, at every blur.
TEST_F(SeenHumanTest, ATermOfTheCoverageLikelihoodAddsUp) {
  const Cameras cameras = {camera_};
  const auto term = std::make_shared<KeypointLikelihood>(body_, cameras, KeypointOptions{});
  const CoverageLikelihood plain(body_, cameras), with(body_, cameras, kFittingRows, {term});
  const std::vector<double> pose = standing(0.2), truth = standing(0);
  Observation seen = see(truth);
  add_keypoints(truth, seen);
  const auto evidence = term->prepare({&seen, 1});
  StateBatch state(1, std::ssize(pose));
  state.row(0) = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), state.cols());
  double log_likelihood = 0;
  term->add_log_likelihood(*evidence, state, {&log_likelihood, 1});
  ASSERT_LT(log_likelihood, -1);
  CoverageLikelihood::Scratch of_plain(plain), of_with(with);
  const CoverageEvidence without_term = plain.evidence_of({&seen, 1}), with_term = with.evidence_of({&seen, 1});
  for (const Blur blur : {Blur::k4, Blur::k32}) {
    const double expected = plain.energy(without_term, blur, pose, of_plain) - 2 * log_likelihood;
    EXPECT_NEAR(with.energy(with_term, blur, pose, of_with), expected, 1e-9 * expected);
    const NormalEquations ours = with.linearise(with_term, blur, pose, of_with);
    const NormalEquations theirs = plain.linearise(without_term, blur, pose, of_plain);
    const NormalEquations alone = term->linearise(*evidence, pose);
    EXPECT_NEAR(ours.energy, expected, 1e-9 * expected);
    EXPECT_LT((ours.gradient - theirs.gradient - alone.gradient).norm(), 1e-9 * ours.gradient.norm());
    EXPECT_LT((ours.hessian - theirs.hessian - alone.hessian).norm(), 1e-9 * ours.hessian.norm());
  }
  const Made sampled = pixels(body_, cameras);
  EXPECT_THROW(CoverageLikelihood(body_, cameras, kFittingRows, {sampled}), std::invalid_argument);
  EXPECT_THROW(CoverageLikelihood(body_, cameras, kFittingRows, {nullptr}), std::invalid_argument);
}

// Half of the mask has no depth and a quarter of the image is ignored: what is left decides, as if nothing were amiss.
TEST_F(SeenHumanTest, DepthThatIsNotKnownDoesNotCount) {
  camera_ = look_at_camera(320, 240, 300, {0, 1.2, 3.5}, {0, 0.9, 0});
  body_ = human_for_test(800);
  const std::vector<double> truth = standing(0.3);
  const auto likelihood = depths(body_, {camera_});
  Observation seen{render_silhouette(*body_, camera_, truth)};
  const Image<float> depth = draw_depth(camera_, skin_vertices(*body_, truth), body_->rest.faces);
  DepthImage measured(320, 240);
  Mask ignored(320, 240);
  const Box box = seen.box();
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (x >= box.x + box.width / 2) continue;
      measured.at(x, y) = static_cast<uint16_t>(std::lround(1000 * depth.at(x, y)));
      if (y >= box.y + box.height / 2) ignored.set(x, y), measured.at(x, y) = 500;
    }
  }
  seen.depth = std::make_shared<const DepthImage>(measured);
  seen.ignored = std::make_shared<const Mask>(ignored);
  StateBatch state(1, std::ssize(truth));
  state.row(0) = Eigen::Map<const Eigen::RowVectorXd>(truth.data(), state.cols());
  double at_truth = 0, off = 0;
  likelihood->add_log_likelihood(*likelihood->prepare({&seen, 1}), state, {&at_truth, 1});
  state(0, dof("root_tz")) += 0.3;
  likelihood->add_log_likelihood(*likelihood->prepare({&seen, 1}), state, {&off, 1});
  EXPECT_GT(at_truth, -4);  // of 40: outlines of another raster
  EXPECT_LT(off, at_truth - 10);
}

TEST_F(SeenHumanTest, ASumNeedsPartsOfOneBody) {
  EXPECT_THROW(SumLikelihood({}), std::invalid_argument);
  EXPECT_THROW(SumLikelihood({nullptr}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
