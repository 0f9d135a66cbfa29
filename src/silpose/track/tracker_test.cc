#include "silpose/track/tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "silpose/base/parallel.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"
#include "silpose/render/silhouette.h"
#include "silpose/track/keypoint_sides.h"
#include "silpose/track/keypoints_for_test.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// The tube upright or bent, at 8 headings: what common poses are for a human.
class TubeProposal : public Proposal {
 public:
  Proposed propose(const ProposalContext&, int, Rng&) const override {
    StateBatch states = StateBatch::Zero(3, 8);
    states(1, 5) = 0.5;
    states(2, 5) = -0.5;
    return {states};
  }
};

// A body, how it moves, and what is expected of a track of it.
struct Rig {
  std::shared_ptr<const BodyModel> body;
  std::function<std::vector<double>(int t)> truth;
  std::shared_ptr<const Proposal> proposal = nullptr;  // none: the poses of its profile
  double most_pixels = 6;                              // mean distance of landmarks from the truth's
  size_t bending = 0;                                  // a DOF that becomes less certain while nothing is seen
  std::optional<size_t> moving = {};                   // the same, of a translation
};

std::vector<double> tube_pose(int t) {
  return {0.01 * t, 0.5, 0, 0, 0, 0.4 * std::sin(0.15 * t), 0, 0.3 * std::cos(0.15 * t)};
}

Rig make_rig(const std::string& name) {
  if (name == "human") {
    const auto body = human_for_test(800);
    const auto truth = [body](int t) {
      std::vector<double> pose = standing_pose(*body);
      const auto set = [&](const char* dof, double value) {
        pose[static_cast<size_t>(*body->skeleton.find_dof(dof))] = value;
      };
      set("root_tx", 0.01 * t);
      set("right_upper_arm_rz", 0.6 + 0.3 * std::sin(0.15 * t));
      set("left_upper_arm_rz", 0.9);
      set("left_thigh_rz", 0.2 + 0.1 * std::sin(0.15 * t));
      return pose;
    };
    const auto arm = static_cast<size_t>(*body->skeleton.find_dof("right_upper_arm_rz"));
    return {.body = body, .truth = truth, .bending = arm, .moving = 0};
  }
  if (name == "chain") {
    const auto truth = [](int t) {
      const double bend = 0.3 * std::sin(0.15 * t);
      return std::vector<double>{0, bend, 0, 0.3, 0, -bend, 0, 0.2};
    };
    return {.body = std::make_shared<BodyModel>(make_chain_body()), .truth = truth, .bending = 3};
  }
  if (name == "rotations_first") {
    return {.body = std::make_shared<BodyModel>(make_rotations_first_body()),
            .truth = [](int t) { return rotations_first(tube_pose(t)); },
            .bending = 2,
            .moving = 6};
  }
  return {.body = std::make_shared<BodyModel>(make_test_body()),
          .truth = tube_pose,
          .proposal = std::make_shared<TubeProposal>(),
          .bending = 5,
          .moving = 0};
}

struct Variant {
  std::string name, preset = "default";
  int particles = 200, layers = 1;  // none: fitted hypotheses
  Metric metric = Metric::kPixelCount;
  std::string rig = "tube";
};

class TrackerTest : public ::testing::TestWithParam<Variant> {
 protected:
  TrackerOptions options() const {
    GivenOptions given;
    if (GetParam().layers > 0) {
      given = {{"particles", int64_t{GetParam().particles}}, {"layers", int64_t{GetParam().layers}}};
    }
    TrackerOptions options = make_tracker_options(GetParam().preset, given);
    if (options.sampling() != nullptr) options.sampling()->metric = GetParam().metric;
    options.body = rig_.body;
    options.cameras = {camera_};
    options.proposal = rig_.proposal;
    return options;
  }
  std::vector<double> truth(int t) const { return rig_.truth(t); }
  Observation observe(int t) const {
    Observation observation;
    observation.mask = render_silhouette(*rig_.body, camera_, truth(t));
    return observation;
  }
  Observation nothing() const {
    Observation observation;
    observation.mask = Mask(camera_.width, camera_.height);
    observation.trust = {.overall = 0, .nothing_found = true};
    return observation;
  }
  static StepReport step(Tracker& tracker, const Observation& observation, int t) {
    return tracker.step({&observation, 1}, t, t * int64_t{33'333'333});
  }
  // Mean distance in the image of a pose's landmarks from the truth's.
  double pixels_off(const std::vector<double>& pose, int t) const {
    const auto found = landmark_positions(*rig_.body, pose), true_ones = landmark_positions(*rig_.body, truth(t));
    double sum = 0;
    for (size_t i = 0; i < found.size(); ++i) {
      sum += (camera_.project(found[i]).value() - camera_.project(true_ones[i]).value()).norm();
    }
    return sum / static_cast<double>(found.size());
  }

  Rig rig_ = make_rig(GetParam().rig);
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
};

TEST_P(TrackerTest, FollowsAMovingBody) {
  Tracker tracker(options());
  double accuracy = 0;
  for (int t = 0; t < 20; ++t) {
    const StepReport report = step(tracker, observe(t), t);
    EXPECT_EQ(report.state, t == 0 ? StepReport::State::kInitialised : StepReport::State::kTracked);
    ASSERT_EQ(report.pose.size(), rig_.body->skeleton.dofs().size());
    if (t < 5) continue;
    accuracy += report.visual_accuracy / 15;
    EXPECT_LT(pixels_off(report.pose, t), rig_.most_pixels);
  }
  EXPECT_GT(accuracy, 0.85);
}

TEST_P(TrackerTest, LimitsAlwaysHold) {
  Tracker tracker(options());
  for (int t = 0; t < 3; ++t) step(tracker, observe(t), t);
  const auto dofs = rig_.body->skeleton.dofs();
  const StateBatch& particles = tracker.particles();
  for (Eigen::Index n = 0; n < particles.rows(); ++n) {
    for (size_t d = 0; d < dofs.size(); ++d) {
      if (!dofs[d].has_limits()) continue;
      ASSERT_GE(particles(n, static_cast<Eigen::Index>(d)), dofs[d].lower);
      ASSERT_LE(particles(n, static_cast<Eigen::Index>(d)), dofs[d].upper);
    }
  }
}

// Stopped while waiting, tracking or coasting, another tracker continues as the first would have.
TEST_P(TrackerTest, GoesOnFromItsStateBitForBit) {
  const auto seen = [&](int t) { return t == 0 || (t >= 4 && t < 6) ? nothing() : observe(t); };
  constexpr int kSteps = 8;
  std::vector<StepReport> expected;
  std::vector<std::string> states;
  Tracker whole(options());
  for (int t = 0; t < kSteps; ++t) {
    states.push_back(whole.state());
    expected.push_back(step(whole, seen(t), t));
  }
  for (const int stop : {1, 3, 5}) {
    Tracker second(options());
    second.restore(states[static_cast<size_t>(stop)]);
    for (int t = stop; t < (stop == 1 ? 3 : kSteps); ++t) {
      const StepReport found = step(second, seen(t), t), &whole_report = expected[static_cast<size_t>(t)];
      EXPECT_EQ(found.state, whole_report.state) << t;
      EXPECT_EQ(found.pose, whole_report.pose) << t;
      EXPECT_EQ(found.mode, whole_report.mode) << t;
      EXPECT_EQ(found.spread, whole_report.spread) << t;
      EXPECT_EQ(found.landmark_spread, whole_report.landmark_spread) << t;
      EXPECT_EQ(found.landmark_spread_about_root, whole_report.landmark_spread_about_root) << t;
      EXPECT_EQ(found.effective_sample_size, whole_report.effective_sample_size) << t;
    }
    if (stop > 1) {
      EXPECT_EQ(whole.noise(), second.noise());
    }
  }
}

TEST_P(TrackerTest, RefusesAnothersState) {
  Tracker tracker(options());
  step(tracker, observe(0), 0);
  const std::string state = tracker.state();
  Tracker other(options());
  EXPECT_THROW(other.restore(state.substr(0, state.size() - 1)), std::invalid_argument);
  EXPECT_THROW(other.restore(""), std::invalid_argument);
}

TEST_P(TrackerTest, WaitsUntilSomethingIsSeenThenCoastsWithGrowingSpread) {
  Tracker tracker(options());
  EXPECT_EQ(step(tracker, nothing(), 0).state, StepReport::State::kWaiting);
  EXPECT_TRUE(step(tracker, nothing(), 1).pose.empty());
  EXPECT_EQ(step(tracker, observe(2), 2).state, StepReport::State::kInitialised);
  const StepReport seen = step(tracker, observe(3), 3);
  for (int t = 4; t < 10; ++t) {
    const StepReport coasted = step(tracker, nothing(), t);
    EXPECT_EQ(coasted.state, StepReport::State::kCoasted);
    EXPECT_EQ(coasted.visual_accuracy, 0);
    if (t == 9) {
      // Of the bend: 2.4 times and more with seeds 1 to 10. The place may be little less certain than it was: where the
      // mixture holds a stray hypothesis, metres away, with hardly any weight, that alone makes most of its spread.
      EXPECT_GT(coasted.spread[rig_.bending], 1.8 * seen.spread[rig_.bending]);
      if (rig_.moving) {
        EXPECT_GT(coasted.spread[*rig_.moving], 1.05 * seen.spread[*rig_.moving]);
      }
    }
  }
  EXPECT_EQ(step(tracker, observe(10), 10).state, StepReport::State::kTracked);
  for (int t = 11; t < 45; ++t) step(tracker, nothing(), t);
  EXPECT_EQ(step(tracker, observe(45), 45).state, StepReport::State::kInitialised);
}

TEST_P(TrackerTest, CoastsOverABadMask) {
  Tracker tracker(options());
  for (int t = 0; t < 3; ++t) step(tracker, observe(t), t);
  Observation bad = observe(3);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 320; ++x) bad.mask.set(x, y);
  }
  bad.trust = {.overall = 0.25, .area_jumped = true};
  const StepReport report = step(tracker, bad, 3);
  EXPECT_EQ(report.state, StepReport::State::kCoasted);
  EXPECT_TRUE(report.trust[0].area_jumped);
  EXPECT_LT(pixels_off(report.pose, 3), rig_.most_pixels);
}

TEST_P(TrackerTest, TheNumberOfThreadsChangesNothing) {
  std::vector<double> poses[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    Tracker tracker(options());
    for (int t = 0; t < 4; ++t) {
      const StepReport report = step(tracker, observe(t), t);
      poses[threads - 1].insert(poses[threads - 1].end(), report.pose.begin(), report.pose.end());
    }
  }
  EXPECT_EQ(poses[0], poses[1]);
}

using SamplingTrackerTest = TrackerTest;
TEST_P(SamplingTrackerTest, AnotherSeedGivesAnotherResult) {
  std::vector<double> poses[2];
  for (const int seed : {1, 2}) {
    auto seeded = options();
    seeded.seed = static_cast<uint64_t>(seed);
    Tracker tracker(seeded);
    step(tracker, observe(0), 0);
    poses[seed - 1] = step(tracker, observe(1), 1).pose;
  }
  EXPECT_NE(poses[0], poses[1]);
}

const auto kSampling = ::testing::Values(Variant{.name = "annealed", .particles = 60, .layers = 8},
                                         Variant{.name = "plain"}, Variant{.name = "thesis", .preset = "thesis"},
                                         Variant{.name = "coverage", .metric = Metric::kCoverage});
const auto kName = [](const auto& variant) { return variant.param.name; };
INSTANTIATE_TEST_SUITE_P(Sampling, TrackerTest, kSampling, kName);
INSTANTIATE_TEST_SUITE_P(Fitted, TrackerTest,
                         ::testing::Values(Variant{.name = "default", .layers = 0},
                                           Variant{.name = "accurate", .preset = "accurate", .layers = 0}),
                         kName);
// The human, a chain with a fixed root, and a rig whose first DOF are rotations about axes of its own.
INSTANTIATE_TEST_SUITE_P(
    Rigs, TrackerTest,
    ::testing::Values(Variant{.name = "human", .layers = 0, .rig = "human"},
                      Variant{.name = "chain", .layers = 0, .rig = "chain"},
                      Variant{.name = "chain_annealed", .particles = 60, .layers = 8, .rig = "chain"},
                      Variant{.name = "rotations_first", .layers = 0, .rig = "rotations_first"},
                      Variant{.name = "rotations_first_plain", .rig = "rotations_first"},
                      Variant{.name = "rotations_first_thesis", .preset = "thesis", .rig = "rotations_first"}),
    kName);
INSTANTIATE_TEST_SUITE_P(Sampling, SamplingTrackerTest, kSampling, kName);

// Where it expects the body is nearer to where it is then than where it was.
TEST_P(TrackerTest, ExpectsTheBodyWhereItGoes) {
  Tracker tracker(options());
  EXPECT_TRUE(tracker.expected(0.03).empty());
  constexpr int64_t kFrame_ns = 33'333'333;
  for (int t = 0; t < 8; ++t) {
    const Observation seen = observe(t);
    tracker.step({&seen, 1}, t, t * kFrame_ns);
  }
  const std::vector<Mask> expected = tracker.expected(1 / 30.0);
  ASSERT_EQ(expected.size(), 1u);
  EXPECT_GT(intersection_over_union(expected[0], observe(8).mask), 0.8);
  const Observation none = nothing();
  tracker.step({&none, 1}, 8, 8 * kFrame_ns);
  EXPECT_TRUE(tracker.expected(0.03).empty());
}

// A body whose network finds keypoints.
class KeypointTrackerTest : public ::testing::Test {
 protected:
  TrackerOptions options(EvidenceKind evidence) const {
    TrackerOptions options;
    options.body = body_;
    options.cameras = {camera_};
    options.landmarks = true;
    options.evidence = evidence;
    return options;
  }
  // Bent to one side, and turned.
  static std::vector<double> truth(int t) { return {0.01 * t, 0.5, 0, 0.6, 0, 0.5, 0, 0.2}; }
  Observation observe(const std::vector<double>& pose) const {
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    return observation;
  }
  Observation with_keypoints(int t, bool exchanged = false) const {
    Observation observation = observe(truth(t));
    add_keypoints(*body_, camera_, truth(t), observation, exchanged);
    return observation;
  }
  double off(const std::vector<double>& pose, int t) const {
    return furthest_apart(landmark_positions(*body_, pose), landmark_positions(*body_, truth(t)));
  }
  static StepReport step(Tracker& tracker, const Observation& observation, int t) {
    return tracker.step({&observation, 1}, t, t * int64_t{33'333'333});
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_sided_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
};

// Stopped before, among and after the frames in which the network exchanges left and right.
TEST_F(KeypointTrackerTest, GoesOnWhereSidesAreExchangedBitForBit) {
  const auto is_exchanged = [](int t) { return t >= 4 && t <= 6; };
  constexpr int kSteps = 10;
  Tracker whole(options(EvidenceKind::kBoth));
  std::vector<StepReport> expected;
  std::vector<std::string> states;
  for (int t = 0; t < kSteps; ++t) {
    states.push_back(whole.state());
    expected.push_back(step(whole, with_keypoints(t, is_exchanged(t)), t));
    ASSERT_EQ(expected.back().exchanged > kExchanged, is_exchanged(t)) << t;
  }
  for (const int stop : {3, 5, 7, 8}) {
    Tracker second(options(EvidenceKind::kBoth));
    second.restore(states[static_cast<size_t>(stop)]);
    for (int t = stop; t < kSteps; ++t) {
      const StepReport found = step(second, with_keypoints(t, is_exchanged(t)), t),
                       &whole_report = expected[static_cast<size_t>(t)];
      EXPECT_EQ(found.exchanged, whole_report.exchanged) << stop << ", " << t;
      EXPECT_EQ(found.pose, whole_report.pose) << stop << ", " << t;
      EXPECT_EQ(found.spread, whole_report.spread) << stop << ", " << t;
      EXPECT_EQ(found.visual_accuracy, whole_report.visual_accuracy) << stop << ", " << t;
    }
  }
}

// Masks are those of a body that is bent to the other side: they do not count.
TEST_F(KeypointTrackerTest, TracksByKeypointsAloneAndCoastsWithoutThem) {
  std::vector<double> other_side = truth(0);
  for (const size_t d : {5u, 7u}) other_side[d] *= -1;
  const Observation silhouette = observe(other_side);
  for (const bool sampling : {false, true}) {
    TrackerOptions of_keypoints = options(EvidenceKind::kKeypoints);
    if (sampling) of_keypoints.filter = SamplingOptions{.num_particles = 300};
    Tracker tracker(of_keypoints);
    EXPECT_EQ(step(tracker, silhouette, 0).state, StepReport::State::kWaiting);
    EXPECT_TRUE(step(tracker, silhouette, 1).pose.empty());
    for (int t = 2; t < 12; ++t) {
      const bool seen = t < 6 || t >= 9;
      Observation observation = silhouette;
      if (seen) add_keypoints(*body_, camera_, truth(t), observation);
      const StepReport report = step(tracker, observation, t);
      EXPECT_EQ(report.state, t == 2 ? StepReport::State::kInitialised
                              : seen ? StepReport::State::kTracked
                                     : StepReport::State::kCoasted)
          << t;
      EXPECT_LT(off(report.pose, t), 0.2) << sampling << ", " << t;
    }
    EXPECT_GT(furthest_apart(landmark_positions(*body_, other_side), landmark_positions(*body_, truth(0))), 0.6);
  }
}

// Started two metres away, particles about the estimate see nothing; those about what a network recognises are there.
// The thesis' filters regenerate only the pose: there it is the pose that starts wrong.
TEST_F(KeypointTrackerTest, RegeneratesFromWhatTheNetworkRecognises) {
  // Metres that the furthest joint is off after five frames. Seeds 1 to 30 gave 0.02 to 0.33 against 2.05 to 2.07, the
  // thesis 0.01 to 0.08 against 0.42 to 1.00.
  struct Start {
    bool separate_root;
    std::vector<double> pose;
    double found, lost;
  };
  for (const Start& start :
       {Start{false, {-2, 0.5, 0, 0, 0, 0, 0, 0}, 0.5, 1.5}, Start{true, {0, 0.5, 0, 0.6, 0, -1, 0, -1}, 0.2, 0.3}}) {
    for (const uint64_t seed : {1u, 2u, 3u}) {
      const auto off_in_the_end = [&](RegenerateFrom regenerate_from) {
        TrackerOptions options = this->options(EvidenceKind::kSilhouette);
        options.filter = SamplingOptions{.num_particles = 200,
                                         .separate_root = start.separate_root,
                                         .resampling = "comb",
                                         .regenerate = 0.2,
                                         .regenerate_from = regenerate_from};
        options.lod_vertices = kSamplingLevel;
        options.seed = seed;
        options.initial_pose = start.pose;
        Tracker tracker(options);
        for (int t = 0; t < 4; ++t) step(tracker, with_keypoints(t), t);
        return off(step(tracker, with_keypoints(4), 4).pose, 4);
      };
      EXPECT_LT(off_in_the_end(RegenerateFrom::kNetwork), start.found) << start.separate_root << seed;
      EXPECT_GT(off_in_the_end(RegenerateFrom::kRandom), start.lost) << start.separate_root << seed;
    }
  }
}

}  // namespace
}  // namespace silpose
