#include "silpose/likelihood/coverage_likelihood.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/simd_targets.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"
#include "silpose/likelihood/coverage_difference.h"
#include "silpose/likelihood/coverage_raster.h"
#include "silpose/likelihood/coverage_reference.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

Observation observation_of(Mask mask) {
  Observation observation;
  observation.mask = std::move(mask);
  return observation;
}

std::shared_ptr<const BodyModel> small_body() { return std::make_shared<const BodyModel>(make_test_body()); }

// A pose with every angle bent a little, standing.
// `apart`: arms and legs off the body. Where limbs overlap, ends of spans come and go, and E has steps that no
// derivative knows of.
std::vector<double> bent_pose(const BodyModel& body, double amount, bool apart = false) {
  std::vector<double> pose = standing_pose(body);
  for (size_t d = 0; d < pose.size(); ++d) {
    const Dof& dof = body.skeleton.dofs()[d];
    if (!dof.is_translation) pose[d] += amount * std::sin(1.7 * static_cast<double>(d) + 0.4);
    if (apart && without_side(dof.name) == "upper_arm_rz") pose[d] += 0.9;
    if (apart && without_side(dof.name) == "thigh_rz") pose[d] += 0.2;
  }
  body.skeleton.clamp(pose);
  return pose;
}

TEST(CoverageRaster, CountsCoveredPartsOfCells) {
  const Observation observation = observation_of(mask_from_text(R"(
    ##..
    ##..
    .#..
    ....
  )"));
  const auto raster = coverage_raster(observation, 2);
  EXPECT_EQ(raster.width, 2);
  EXPECT_FLOAT_EQ(raster.observed[raster.at(0, 0)], 1.0f);
  EXPECT_FLOAT_EQ(raster.observed[raster.at(0, 1)], 0.25f);
  EXPECT_FLOAT_EQ(raster.observed[raster.at(1, 0)], 0.0f);
  EXPECT_EQ(raster.occupied, (Box{0, 0, 1, 2}));
}

TEST(OutlineLength, OfADiscIsItsCircumference) {
  Mask mask(200, 200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (std::hypot(x - 99.5, y - 99.5) < 70) mask.set(x, y);
    }
  }
  EXPECT_NEAR(outline_length(observation_of(mask)), 2 * kPi * 70, 10);
}

// An axis-aligned block that is one pixel off to the right: both upright sides are, and E is their length.
TEST(CoverageDifference, CountsSquaredPixelsAlongTheOutline) {
  Mask mask(256, 256);
  for (int y = 64; y < 192; ++y) {
    for (int x = 64; x < 192; ++x) mask.set(x, y);
  }
  for (const int cell : {2, 4, 8}) {
    const auto raster = coverage_raster(observation_of(mask), cell);
    std::vector<float> x, side;
    std::vector<int32_t> row;
    for (int r = 128 / cell; r < 384 / cell; ++r) {
      x.insert(x.end(), {65, 193});
      side.insert(side.end(), {1, -1});
      row.insert(row.end(), {r, r});
    }
    const size_t count = x.size();
    x.resize(count + kSpanSpare);
    side.resize(x.size());
    row.resize(x.size());
    CoverageDifference difference;
    difference.start(raster, 256, 2);
    difference.add_model({x.data(), side.data(), row.data(), nullptr, count});
    const double scale = 2 * std::sqrt(kPi) * cell * cell * cell;
    EXPECT_NEAR(scale * difference.finish(), 256, 20) << "cells of " << cell;
  }
}

TEST(CoverageLikelihood, IsSmallestAtTheTruth) {
  const auto body = small_body();
  const PinholeCamera camera = look_at_camera(320, 240, 350, {0, 1, 3.5}, {0, 1, 0});
  const CoverageLikelihood likelihood(body, {camera});
  CoverageLikelihood::Scratch scratch(likelihood);
  const std::vector<double> truth = bent_pose(*body, 0.3);
  const auto evidence = likelihood.evidence_of(std::vector{observation_of(render_silhouette(*body, camera, truth))});
  for (const Blur blur : {Blur::k2, Blur::k4, Blur::k8, Blur::k16}) {
    const double at_truth = likelihood.energy(evidence, blur, truth, scratch);
    for (size_t d = 0; d < truth.size(); ++d) {
      for (const double step : {-0.1, 0.1}) {
        std::vector<double> off = truth;
        off[d] += step;
        EXPECT_GE(likelihood.energy(evidence, blur, off, scratch), at_truth * 0.98) << d;
      }
    }
  }
}

struct DerivativeCase {
  const char* name;
  bool is_human;
  double distortion;
  int num_cameras;
};
class CoverageDerivative : public testing::TestWithParam<DerivativeCase> {};

// Against central differences, for every DOF. E has small steps where an end comes or goes on a sampled row: here rows
// are fine.
TEST_P(CoverageDerivative, AgreesWithFiniteDifferences) {
  const auto body = GetParam().is_human ? human_for_test(4000) : small_body();
  std::vector<PinholeCamera> cameras = {look_at_camera(640, 480, 600, {0.5, 1.2, 3.5}, {0, 0.9, 0})};
  if (GetParam().num_cameras > 1) cameras.push_back(look_at_camera(640, 480, 600, {3.5, 1.2, 0.5}, {0, 0.9, 0}));
  for (PinholeCamera& camera : cameras)
    camera.distortion = {GetParam().distortion, 0, 0.5 * GetParam().distortion, 0, 0};
  const CoverageLikelihood likelihood(body, cameras, 64);
  CoverageLikelihood::Scratch scratch(likelihood);
  const std::vector<double> truth = bent_pose(*body, 0.3, true), pose = bent_pose(*body, 0.22, true);
  std::vector<Observation> observations;
  for (const PinholeCamera& camera : cameras)
    observations.push_back(observation_of(render_silhouette(*body, camera, truth)));
  const auto evidence = likelihood.evidence_of(observations);
  for (const Blur blur : {Blur::k4, Blur::k8}) {
    const NormalEquations equations = likelihood.linearise(evidence, blur, pose, scratch);
    EXPECT_NEAR(equations.energy, likelihood.energy(evidence, blur, pose, scratch), 1e-6 * equations.energy);
    for (size_t d = 0; d < pose.size(); ++d) {
      std::vector<double> more = pose, less = pose;
      const double step = 0.001;  // metres or radians
      more[d] += step;
      less[d] -= step;
      const double slope =
          (likelihood.energy(evidence, blur, more, scratch) - likelihood.energy(evidence, blur, less, scratch)) /
          (4 * step);
      const auto i = static_cast<Eigen::Index>(d);
      // What one standard deviation of this DOF alone would change: the natural scale of its slope.
      const double scale = std::sqrt(equations.hessian(i, i) * equations.energy);
      EXPECT_NEAR(equations.gradient[i], slope, 0.05 * scale + 1e-9) << body->skeleton.dofs()[d].name;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Bodies, CoverageDerivative,
                         testing::Values(DerivativeCase{"TestBody", false, 0, 1}, DerivativeCase{"Human", true, 0, 1},
                                         DerivativeCase{"Distorted", true, -0.15, 1},
                                         DerivativeCase{"TwoCameras", true, 0, 2}),
                         [](const auto& the_case) { return the_case.param.name; });

// Against every triangle by itself, in double precision; also where the image cuts the body off, and where little of
// it is trusted.
TEST_P(CoverageDerivative, AgreesWithThePlainReference) {
  const auto body = GetParam().is_human ? human_for_test(4000) : small_body();
  std::vector<PinholeCamera> cameras = {look_at_camera(320, 240, 300, {0.5, 1.2, 3.5}, {0, 0.9, 0})};
  if (GetParam().num_cameras > 1) cameras.push_back(look_at_camera(320, 240, 300, {1.5, 1.2, 0.5}, {0, 0.9, 0}));
  for (PinholeCamera& camera : cameras)
    camera.distortion = {GetParam().distortion, 0, 0.5 * GetParam().distortion, 0.01 * GetParam().distortion, 0};
  const CoverageLikelihood likelihood(body, cameras);
  CoverageLikelihood::Scratch scratch(likelihood);
  const std::vector<double> truth = bent_pose(*body, 0.3);
  for (const double bend : {0.22, -0.3}) {
    const std::vector<double> pose = bent_pose(*body, bend);
    std::vector<Observation> observations;
    for (const PinholeCamera& camera : cameras) {
      Observation observation = observation_of(render_silhouette(*body, camera, truth));
      observation.confidence = ByteImage(320, 240, 1, 255);
      for (int y = 0; y < 120 && bend < 0; ++y) {
        for (int x = 0; x < 320; ++x) observation.confidence.at(x, y) = static_cast<uint8_t>(x % 200);
      }
      observations.push_back(std::move(observation));
    }
    const auto evidence = likelihood.evidence_of(observations);
    for (const Blur blur : {Blur::k2, Blur::k4, Blur::k16}) {
      const NormalEquations theirs = linearise_reference(*body, cameras, evidence, blur, pose);
      for_each_simd_target([&](const char* target) {
        SCOPED_TRACE(target);
        const NormalEquations ours = likelihood.linearise(evidence, blur, pose, scratch);
        EXPECT_NEAR(ours.energy, theirs.energy, 1e-4 * theirs.energy);
        EXPECT_NEAR(likelihood.energy(evidence, blur, pose, scratch), theirs.energy, 1e-4 * theirs.energy);
        EXPECT_LT((ours.gradient - theirs.gradient).norm(), 1e-4 * theirs.gradient.norm());
        EXPECT_LT((ours.hessian - theirs.hessian).norm(), 1e-4 * theirs.hessian.norm());
        EXPECT_EQ(ours.hessian, ours.hessian.transpose());
        // Scratch that was used for another pose and blur changes nothing.
        CoverageLikelihood::Scratch fresh(likelihood);
        EXPECT_EQ(likelihood.linearise(evidence, blur, pose, fresh).hessian, ours.hessian);
      });
    }
  }
}

// A body that one camera sees in a known pose.
class OneViewTest : public ::testing::Test {
 protected:
  [[nodiscard]] double energy(const Observation& seen, Blur blur = Blur::k4) {
    return likelihood_.energy(likelihood_.evidence_of(std::vector{seen}), blur, truth_, scratch_);
  }

  std::shared_ptr<const BodyModel> body_ = small_body();
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1, 3.5}, {0, 0.75, 0});
  CoverageLikelihood likelihood_{body_, {camera_}};
  CoverageLikelihood::Scratch scratch_{likelihood_};
  std::vector<double> truth_ = bent_pose(*body_, 0.3);
  Observation whole_ = observation_of(render_silhouette(*body_, camera_, truth_));
};

TEST_F(OneViewTest, IgnoresWhereItIsNotConfident) {
  Observation observation = whole_;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) observation.mask.set(x, y);
  }
  const double fooled = energy(observation);
  Mask ignored(320, 240);
  observation.confidence = ByteImage(320, 240, 1, 255);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) observation.confidence.at(x, y) = 0, ignored.set(x, y);
  }
  const double doubted = energy(observation);
  EXPECT_LT(doubted, 0.6 * fooled);
  EXPECT_GT(doubted, 0.1 * fooled) << "doubtful pixels keep half of their weight";
  observation.confidence = {};
  observation.ignored = std::make_shared<const Mask>(ignored);
  const double warned = energy(observation);
  EXPECT_LT(warned, 0.01 * fooled);
}

// An occluder across the body, whose edges cut through cells: what is behind it neither pulls nor counts as outline.
TEST_F(OneViewTest, ABodyBehindIgnoredPixelsStaysWhereItIs) {
  Observation cut = whole_;
  const Box box = whole_.box();
  Mask occluder(320, 240);
  for (int y = box.y + box.height / 3; y < box.y + box.height / 3 + 21; ++y) {
    for (int x = 0; x < 320; ++x) occluder.set(x, y), cut.mask.set(x, y, false);
  }
  Observation known = cut;
  known.ignored = std::make_shared<const Mask>(occluder);
  EXPECT_LT(outline_length(known), outline_length(whole_));
  for (const Blur blur : {Blur::k2, Blur::k4, Blur::k8}) {
    const double whole = energy(whole_, blur), fooled = energy(cut, blur);
    EXPECT_LT(energy(known, blur), whole + 0.05 * (fooled - whole)) << static_cast<int>(blur);
  }
}

TEST(CoverageLikelihood, RefusesAMaskOfAnotherSize) {
  const CoverageLikelihood likelihood(small_body(), {default_camera(320, 240)});
  EXPECT_THROW((void)likelihood.evidence_of(std::vector{observation_of(Mask(64, 48))}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
