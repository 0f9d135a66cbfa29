#include "silpose/motion/motion_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/body/human_profile.h"
#include "silpose/body/test_body.h"
#include "silpose/filter/estimate.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

Skeleton human() {
  const std::vector<Eigen::Vector3d> centres(20, Eigen::Vector3d::Zero());
  return human_skeleton(centres);
}

RigProfile profile_of(const Skeleton& skeleton) { return human_profile(skeleton); }

StateBatch copies(const std::vector<double>& pose, int num_particles) {
  StateBatch poses(num_particles, static_cast<Eigen::Index>(pose.size()));
  for (int i = 0; i < num_particles; ++i)
    poses.row(i) = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), poses.cols());
  return poses;
}

// In the middle of every range, far from limits.
std::vector<double> middle(const Skeleton& skeleton) {
  return skeleton.denormalise(std::vector(static_cast<size_t>(skeleton.num_dofs()), 0.5));
}

bool within_limits(const Skeleton& skeleton, const StateBatch& states) {
  for (const Dof& dof : skeleton.dofs()) {
    if (dof.is_translation) continue;
    const auto column = states.col(&dof - skeleton.dofs().data());
    if (column.minCoeff() < dof.lower || column.maxCoeff() > dof.upper) return false;
  }
  return true;
}

// The contract on top of motion_model.h, for every model.
class MotionModelContract : public testing::TestWithParam<const char*> {
 protected:
  Skeleton skeleton_ = human();
  std::unique_ptr<MotionModel> model_ = make_motion_model(GetParam(), skeleton_, profile_of(skeleton_)).value();

  // With hidden states that are made for this batch size.
  void propagate(StateBatch& states, const MotionContext& context) {
    if (hidden_size_ != states.rows()) hidden_ = model_->make_hidden(static_cast<int>(states.rows()));
    hidden_size_ = states.rows();
    model_->propagate(states, hidden_.get(), context);
  }

 private:
  std::unique_ptr<HiddenStates> hidden_;
  Eigen::Index hidden_size_ = -1;
};

TEST_P(MotionModelContract, StatesStartWithThePose) {
  const StateBatch poses = copies(middle(skeleton_), 3);
  const StateBatch states = model_->states_from_poses(poses);
  EXPECT_EQ(states.cols(), model_->state_size());
  EXPECT_EQ(model_->deviation().size(), static_cast<size_t>(model_->state_size()));
  EXPECT_TRUE((states.leftCols(37).array() == poses.array()).all());
  EXPECT_THROW((void)model_->states_from_poses(StateBatch::Zero(3, 36)), std::invalid_argument);
}

TEST_P(MotionModelContract, LimitsAlwaysHold) {
  StateBatch states = model_->states_from_poses(copies(skeleton_.denormalise(std::vector(37, 1.0)), 300));
  for (uint64_t step = 0; step < 40; ++step) {
    propagate(states, {.dt_s = 0.2, .seed = 1, .stream = step});
    ASSERT_TRUE(within_limits(skeleton_, states)) << step;
    ASSERT_TRUE(states.allFinite());
  }
  model_->diffuse(states, std::vector(static_cast<size_t>(model_->state_size()), 10.0), 1, 99);
  EXPECT_TRUE(within_limits(skeleton_, states));
}

TEST_P(MotionModelContract, NoTimeMovesNothing) {
  const StateBatch before = model_->states_from_poses(copies(middle(skeleton_), 3));
  StateBatch states = before;
  propagate(states, {.dt_s = 0, .seed = 1, .stream = 1});
  EXPECT_TRUE(states.isApprox(before, 1e-12));
  model_->diffuse(states, std::vector(static_cast<size_t>(model_->state_size()), 0.0), 1, 1);
  EXPECT_TRUE(states.isApprox(before, 1e-12));
}

TEST_P(MotionModelContract, SpreadDoesNotDependOnTheFrameRate) {
  const auto spread_after_a_tenth = [&](int num_steps) {
    StateBatch states = model_->states_from_poses(copies(middle(skeleton_), 4000));
    for (int step = 0; step < num_steps; ++step) {
      propagate(states, {.dt_s = 0.1 / num_steps, .seed = 7, .stream = static_cast<uint64_t>(step)});
    }
    return weighted_deviation(states, std::vector(4000, 1.0));
  };
  const std::vector<double> coarse = spread_after_a_tenth(6), fine = spread_after_a_tenth(24);
  for (size_t d = 0; d < coarse.size(); ++d) EXPECT_NEAR(coarse[d], fine[d], 0.08 * fine[d]) << d;
}

TEST_P(MotionModelContract, IsTheSameOnAnyNumberOfThreads) {
  const auto run = [&](int num_threads) {
    const ThreadLimit limit(num_threads);
    StateBatch states = model_->states_from_poses(copies(middle(skeleton_), 500));
    for (uint64_t step = 0; step < 3; ++step) propagate(states, {.dt_s = 1.0 / 30, .seed = 3, .stream = step});
    model_->diffuse(states, model_->deviation(), 3, 4);
    return states;
  };
  EXPECT_TRUE((run(1).array() == run(2).array()).all());
}

TEST_P(MotionModelContract, ColumnsOfADofAreItsOwn) {
  std::vector<bool> seen(static_cast<size_t>(model_->state_size()), false);
  for (int d = 0; d < 37; ++d) {
    const std::vector<int> columns = model_->columns_of(std::vector{d});
    EXPECT_EQ(columns.front(), d);
    for (const int column : columns) {
      EXPECT_FALSE(seen[static_cast<size_t>(column)]);
      seen[static_cast<size_t>(column)] = true;
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0);
}

TEST_P(MotionModelContract, RefusesBadInput) {
  StateBatch states = model_->states_from_poses(copies(middle(skeleton_), 2));
  EXPECT_THROW(propagate(states, {.dt_s = -1, .seed = 1, .stream = 1}), std::invalid_argument);
  EXPECT_THROW(model_->diffuse(states, std::vector{1.0}, 1, 1), std::invalid_argument);
  StateBatch narrow = StateBatch::Zero(2, 3);
  EXPECT_THROW(propagate(narrow, {.dt_s = 0.1, .seed = 1, .stream = 1}), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(All, MotionModelContract, testing::Values("diffusion", "first-order-augmented"),
                         [](const auto& param) {
                           std::string name = param.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(Diffusion, HasTheDeviationOfItsNoiseAndNoDrift) {
  const Skeleton skeleton = human();
  const auto model = make_motion_model("diffusion", skeleton, profile_of(skeleton)).value();
  const std::vector<double> start = middle(skeleton);
  StateBatch states = model->states_from_poses(copies(start, 20000));
  model->propagate(states, nullptr, {.dt_s = 4.0 / 30, .seed = 1, .stream = 1});  // four frames: twice the deviation
  const std::vector<double> weight(20000, 1.0);
  const std::vector<double> mean = weighted_mean(states, weight), spread = weighted_deviation(states, weight);
  for (size_t d = 0; d < 37; ++d) {
    const double expected = 2 * model->deviation()[d];
    EXPECT_NEAR(spread[d], expected, 0.03 * expected) << d;
    EXPECT_NEAR(mean[d], start[d], 0.03 * expected) << d;
  }
}

TEST(Diffusion, WrapsHeadings) {
  const Skeleton skeleton = human();
  const auto model = make_motion_model("diffusion", skeleton, profile_of(skeleton)).value();
  std::vector<double> pose(37, 0.0);
  const int heading = *skeleton.find_dof("root_ry");
  pose[static_cast<size_t>(heading)] = to_radians(179);
  StateBatch states = copies(pose, 2000);
  model->propagate(states, nullptr, {.dt_s = 1.0 / 30, .seed = 1, .stream = 1});
  EXPECT_LE(states.col(heading).maxCoeff(), kPi);
  EXPECT_GE(states.col(heading).minCoeff(), -kPi);
  EXPECT_GT((states.col(heading).array() < 0).count(), 300);
  const std::vector<int> circular = {heading};
  EXPECT_NEAR(weighted_mean(states, std::vector(2000, 1.0), circular)[static_cast<size_t>(heading)], to_radians(179),
              to_radians(0.3));
}

// eq. 2.18 without noise to speak of.
TEST(FirstOrderAugmented, MovesByItsVelocity) {
  const Skeleton skeleton = human();
  const auto model =
      make_motion_model("first-order-augmented", skeleton, profile_of(skeleton), {.sigma_deg = 1e-9}).value();
  const int shin = *skeleton.find_dof("right_shin_rx"), heading = *skeleton.find_dof("root_ry");
  StateBatch states = model->states_from_poses(copies(std::vector(37, 0.0), 1));
  states(0, 37 + shin) = to_radians(100);  // per second
  states(0, 37 + heading) = to_radians(100);
  for (uint64_t step = 0; step < 10; ++step)
    model->propagate(states, nullptr, {.dt_s = 0.1, .seed = 1, .stream = step});
  EXPECT_NEAR(states(0, shin), to_radians(100), 1e-6);
  EXPECT_NEAR(states(0, heading), to_radians(100), 1e-6);
  for (uint64_t step = 10; step < 20; ++step)
    model->propagate(states, nullptr, {.dt_s = 0.1, .seed = 1, .stream = step});
  EXPECT_NEAR(states(0, shin), to_radians(150), 1e-12);  // the knee stops at its limit
  EXPECT_NEAR(states(0, 37 + shin), 0, 1e-12);
  EXPECT_NEAR(states(0, heading), to_radians(-160), 1e-6);  // the heading goes around
  EXPECT_NEAR(states(0, 37 + heading), to_radians(100), 1e-6);
}

TEST(FirstOrderAugmented, VelocityDecays) {
  const Skeleton skeleton = make_test_body().skeleton;
  const auto model = make_motion_model("first-order-augmented", skeleton, profile_of(skeleton),
                                       {.sigma_deg = 1e-9, .velocity_decay_per_s = 2})
                         .value();
  StateBatch states = StateBatch::Zero(1, 16);
  states(0, 8) = 1;
  for (uint64_t step = 0; step < 50; ++step)
    model->propagate(states, nullptr, {.dt_s = 0.01, .seed = 1, .stream = step});
  EXPECT_NEAR(states(0, 8), std::exp(-1.0), 1e-9);
  EXPECT_THROW(
      (void)make_motion_model("first-order-augmented", skeleton, profile_of(skeleton), {.velocity_decay_per_s = -1}),
      std::invalid_argument);
}

// A joint on a rail stays on it, and stops at its end.
TEST(FirstOrderAugmented, BoundedTranslationsStopAtTheirLimits) {
  const Dof rail{.name = "rail", .is_translation = true, .lower = -0.1, .upper = 0.2, .is_bounded = true};
  const Skeleton skeleton("s", {{.name = "root", .dof_indices = {0}}}, {rail});
  const auto model =
      make_motion_model("first-order-augmented", skeleton, tree_profile(skeleton), {.sigma_deg = 1e-9}).value();
  StateBatch states = StateBatch::Zero(1, 2);
  states(0, 1) = 1;
  for (uint64_t step = 0; step < 5; ++step) model->propagate(states, nullptr, {.dt_s = 0.1, .seed = 1, .stream = step});
  EXPECT_NEAR(states(0, 0), 0.2, 1e-9);  // noise moves it off its end again
  EXPECT_LE(states(0, 0), 0.2);
  EXPECT_NEAR(states(0, 1), 0, 1e-9);
}

TEST(Noise, ScalesWithSigma) {
  const RigProfile profile = make_test_body().profile;
  const std::vector<double> deviation = noise_deviation(profile), half = noise_deviation(profile, kTypicalSigmaDeg / 2);
  EXPECT_EQ(deviation, profile.noise);
  for (size_t d = 0; d < 8; ++d) EXPECT_EQ(half[d], deviation[d] / 2);
  EXPECT_THROW((void)noise_deviation(profile, 0), std::invalid_argument);
  EXPECT_THROW((void)noise_deviation(profile, std::nan("")), std::invalid_argument);
}

TEST(MakeMotionModel, RefusesTheProfileOfAnotherRig) {
  EXPECT_THROW((void)make_motion_model("diffusion", human(), make_test_body().profile), std::invalid_argument);
}

TEST(MakeMotionModel, NamesWhatItDoesNotKnow) {
  const Skeleton skeleton = human();
  for (const char* name :
       {"wobble", "first-order", "first-order-filter", "second-order", "knn", "transition", "physics"}) {
    const auto model = make_motion_model(name, skeleton, profile_of(skeleton));
    ASSERT_FALSE(model.ok()) << name;
    EXPECT_EQ(model.error().message, std::string("motion '") + name + "': not one of diffusion, first-order-augmented");
  }
}

}  // namespace
}  // namespace silpose
