// What a program may add to a tracker or replace in it: likelihoods, motion models, metrics, backends, proposals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "silpose/base/state_bytes.h"
#include "silpose/body/test_body.h"
#include "silpose/filter/resampling.h"
#include "silpose/shape/normalised_silhouette.h"
#include "silpose/track/tracker.h"

namespace silpose {
namespace {

constexpr int64_t kFrame_ns = 33'333'333;
constexpr int kNumParticles = 60;

// A sensor that knows where the root is along x, one DOF of the tube.
class RootSensor final : public PoseLikelihood {
 public:
  RootSensor(std::shared_ptr<const BodyModel> body, double x, double deviation, bool linearises)
      : body_(std::move(body)), x_(x), deviation_(deviation), linearises_(linearises) {}
  const BodyModel& body() const override { return *body_; }
  std::unique_ptr<const Evidence> prepare(std::span<const Observation>) const override {
    return std::make_unique<Evidence>();
  }
  void add_log_likelihood(const Evidence&, const StateBatch& states, std::span<double> out) const override {
    for (size_t n = 0; n < out.size(); ++n) out[n] -= 0.5 * energy(states(static_cast<Eigen::Index>(n), 0));
  }
  bool can_linearise() const override { return linearises_; }
  NormalEquations linearise(const Evidence& evidence, std::span<const double> pose) const override {
    if (!linearises_) return PoseLikelihood::linearise(evidence, pose);
    const Eigen::Index D = std::ssize(pose);
    NormalEquations equations{energy(pose[0]), Eigen::VectorXd::Zero(D), Eigen::MatrixXd::Zero(D, D)};
    equations.gradient[0] = (pose[0] - x_) / (deviation_ * deviation_);
    equations.hessian(0, 0) = 1 / (deviation_ * deviation_);
    return equations;
  }

 private:
  double energy(double x) const { return std::pow((x - x_) / deviation_, 2); }
  std::shared_ptr<const BodyModel> body_;
  double x_, deviation_;
  bool linearises_;
};

// Goes on at the velocity of the last two estimates, and counts in hidden states how often each particle's line moved.
class Counting final : public MotionModel {
 public:
  struct Hidden final : HiddenStates {
    // [N] How often a particle's line moved; a number that the first of the line was given; column 0 after the motion.
    std::vector<double> moves, first, column;
    int num_selections = 0;
    void select(std::span<const int> ancestors) override {
      const Hidden before = *this;
      for (size_t n = 0; n < moves.size(); ++n) {
        const int from = ancestors[n];
        moves[n] = from == kRegenerate ? 0 : before.moves[static_cast<size_t>(from)];
        first[n] = from == kRegenerate ? -1 : before.first[static_cast<size_t>(from)];
        column[n] = from == kRegenerate ? 0 : before.column[static_cast<size_t>(from)];
      }
      ++num_selections;
    }
    std::string state() const override { return to_bytes(moves, first, column, num_selections); }
    void restore(std::string_view state) override {
      if (!from_bytes(state, moves, first, column, num_selections))
        throw std::invalid_argument("Counting: not a state of it");
    }
  };

  explicit Counting(const BodyModel& body)
      : plain_(make_motion_model("diffusion", body.skeleton, body.profile).value()) {}
  int state_size() const override { return plain_->state_size(); }
  StateBatch states_from_poses(const StateBatch& poses) const override { return plain_->states_from_poses(poses); }
  std::vector<int> columns_of(std::span<const int> dofs) const override { return plain_->columns_of(dofs); }
  std::span<const double> deviation() const override { return plain_->deviation(); }
  int history_length() const override { return 2; }
  std::unique_ptr<HiddenStates> make_hidden(int num_particles) const override {
    auto hidden = std::make_unique<Hidden>();
    hidden->moves.assign(static_cast<size_t>(num_particles), 0);
    hidden->column.assign(static_cast<size_t>(num_particles), 0);
    for (int n = 0; n < num_particles; ++n) hidden->first.push_back(n);
    last_ = hidden.get();
    return hidden;
  }
  void propagate(StateBatch& states, HiddenStates* hidden, const MotionContext& context) const override {
    histories_.push_back({context.history.begin(), context.history.end()});
    auto& own = dynamic_cast<Hidden&>(*hidden);
    for (size_t n = 0; n < own.moves.size(); ++n) {
      num_wrong_ += own.moves[n] > 0 && own.column[n] != states(static_cast<Eigen::Index>(n), 0);
      ++own.moves[n];
    }
    if (context.history.size() == 2) {
      const auto& [before, last] = std::pair(context.history[0], context.history[1]);
      const double share = context.dt_s / (before.seconds_ago - last.seconds_ago);
      for (Eigen::Index d = 0; d < states.cols(); ++d) {
        const auto i = static_cast<size_t>(d);
        states.col(d).array() += share * (last.pose[i] - before.pose[i]);
      }
    }
    plain_->propagate(states, nullptr, context);
    for (size_t n = 0; n < own.moves.size(); ++n) own.column[n] = states(static_cast<Eigen::Index>(n), 0);
  }
  void diffuse(StateBatch& states, std::span<const double> deviation, uint64_t seed, uint64_t stream) const override {
    plain_->diffuse(states, deviation, seed, stream);
  }

  mutable Hidden* last_ = nullptr;
  mutable int num_wrong_ = 0;  // particles whose hidden state is another one's
  mutable std::vector<std::vector<MotionContext::Past>> histories_;

 private:
  std::unique_ptr<MotionModel> plain_;
};

// Two candidates, one far more likely than the other.
class Unlike final : public Proposal {
 public:
  Proposed propose(const ProposalContext& context, int, Rng&) const override {
    contexts_.push_back({{context.last_pose.begin(), context.last_pose.end()}, context.dt_s});
    Proposed proposed{StateBatch::Zero(2, 8), {-1e3, 0}};
    proposed.poses(0, 0) = 1.5;
    proposed.poses(1, 0) = 0.5;
    proposed.poses(0, 1) = proposed.poses(1, 1) = 0.5;
    return proposed;
  }
  mutable std::vector<std::pair<std::vector<double>, double>> contexts_;
};

class Nothing final : public Proposal {
 public:
  Proposed propose(const ProposalContext&, int, Rng&) const override { return {}; }
};
class Wrong final : public Proposal {
 public:
  Proposed propose(const ProposalContext&, int, Rng&) const override { return {StateBatch::Zero(2, 3)}; }
};

class OwnPartsTest : public testing::Test {
 protected:
  TrackerOptions options(std::variant<FittedOptions, SamplingOptions> filter) const {
    TrackerOptions options{.body = body_, .cameras = {camera_}, .filter = std::move(filter)};
    options.initial_pose = pose(0);
    return options;
  }
  TrackerOptions sampling(int num_layers = 1) const {
    return options(SamplingOptions{.num_particles = kNumParticles, .num_layers = num_layers});
  }
  static std::vector<double> pose(int t) { return {0.02 * t, 0.5, 0, 0, 0, 0.3, 0, 0}; }
  StepReport step(Tracker& tracker, int t) const {
    Observation seen{render_silhouette(*body_, camera_, pose(t))};
    return tracker.step({&seen, 1}, t, t * kFrame_ns);
  }
  std::vector<double> last_pose(const TrackerOptions& options, int num_steps = 6) const {
    Tracker tracker(options);
    std::vector<double> last;
    for (int t = 0; t < num_steps; ++t) last = step(tracker, t).pose;
    return last;
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
};

// A sensor that contradicts the silhouettes pulls every filter its way, the harder the surer it is.
TEST_F(OwnPartsTest, AnOwnLikelihoodPulls) {
  const TrackerOptions two_filters =
      options(SamplingOptions{.num_particles = kNumParticles, .separate_root = true, .sharpness = 40});
  for (const auto& filter : {options(FittedOptions{}), sampling(), sampling(4), two_filters}) {
    TrackerOptions pulled = filter;
    pulled.likelihoods = {std::make_shared<RootSensor>(body_, 0.6, 0.002, true)};
    const double free = last_pose(filter)[0], held = last_pose(pulled)[0];
    EXPECT_NEAR(free, 0.1, 0.06);
    EXPECT_GT(held, free + 0.1);
    pulled.likelihoods = {std::make_shared<RootSensor>(body_, 0.6, 100, true)};
    EXPECT_NEAR(last_pose(pulled)[0], free, 0.05);
  }
}

TEST_F(OwnPartsTest, TheFittedMixtureNeedsALinearisation) {
  TrackerOptions fitted = options(FittedOptions{});
  fitted.likelihoods = {std::make_shared<RootSensor>(body_, 0.6, 1, false)};
  EXPECT_THROW(Tracker{fitted}, std::invalid_argument);
  TrackerOptions sampled = sampling();
  sampled.likelihoods = fitted.likelihoods;
  EXPECT_EQ(last_pose(sampled, 2).size(), 8u);
  sampled.likelihoods = {nullptr};
  EXPECT_THROW(Tracker{sampled}, std::invalid_argument);
  TrackerOptions with_motion = options(FittedOptions{});
  with_motion.motion_model = std::make_shared<Counting>(*body_);
  EXPECT_THROW(Tracker{with_motion}, std::invalid_argument);
}

// Hidden states go where their particles go: after resampling every line has moved as often as there were steps, and
// few of the first particles have descendants.
TEST_F(OwnPartsTest, HiddenStatesFollowTheirParticles) {
  for (const int num_layers : {1, 4}) {
    TrackerOptions own = sampling(num_layers);
    const auto motion = std::make_shared<Counting>(*body_);
    own.motion_model = motion;
    Tracker tracker(own);
    for (int t = 0; t < 5; ++t) step(tracker, t);
    ASSERT_NE(motion->last_, nullptr);
    const Counting::Hidden& hidden = *motion->last_;
    EXPECT_EQ(hidden.moves, std::vector<double>(kNumParticles, 5));
    EXPECT_EQ(hidden.num_selections, 5 * num_layers);
    if (num_layers == 1) {
      EXPECT_EQ(motion->num_wrong_, 0);  // annealing moves particles between its layers
    }
    std::vector<double> lines = hidden.first;
    std::ranges::sort(lines);
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    EXPECT_LT(lines.size(), kNumParticles / 2);
  }
}

TEST_F(OwnPartsTest, AMotionModelIsGivenTheLastEstimates) {
  TrackerOptions own = sampling();
  const auto motion = std::make_shared<Counting>(*body_);
  own.motion_model = motion;
  Tracker tracker(own);
  std::vector<std::vector<double>> estimates;
  for (int t = 0; t < 4; ++t) estimates.push_back(step(tracker, t).pose);
  ASSERT_EQ(motion->histories_.size(), 4u);
  EXPECT_TRUE(motion->histories_[0].empty());
  EXPECT_EQ(motion->histories_[1].size(), 1u);
  ASSERT_EQ(motion->histories_[3].size(), 2u);
  EXPECT_EQ(motion->histories_[3][0].pose, estimates[1]);
  EXPECT_EQ(motion->histories_[3][1].pose, estimates[2]);
  EXPECT_NEAR(motion->histories_[3][0].seconds_ago, 1e-9 * kFrame_ns, 1e-12);
  EXPECT_EQ(motion->histories_[3][1].seconds_ago, 0);
}

TEST_F(OwnPartsTest, HiddenStatesAndHistoryResume) {
  TrackerOptions own = sampling();
  own.motion_model = std::make_shared<Counting>(*body_);
  Tracker whole(own);
  for (int t = 0; t < 3; ++t) step(whole, t);
  const std::string state = whole.state();
  TrackerOptions other = sampling();
  const auto motion = std::make_shared<Counting>(*body_);
  other.motion_model = motion;
  Tracker resumed(other);
  resumed.restore(state);
  for (int t = 3; t < 6; ++t) EXPECT_EQ(step(resumed, t).pose, step(whole, t).pose) << t;
  EXPECT_EQ(motion->last_->moves, std::vector<double>(kNumParticles, 6));
}

// 1 - intersection over union, by looking at the silhouettes.
class Jaccard final : public ShapeMetric {
 public:
  struct Seen final : Description {
    Mask mask;
  };
  std::unique_ptr<const Description> describe(const Mask& observed, const Mask*, const Window& window) const override {
    auto seen = std::make_unique<Seen>();
    seen->mask = resample_mask(observed, window);
    return seen;
  }
  void distances(const Description& observed, std::span<const Mask> masks, std::span<double> out) const override {
    for (size_t n = 0; n < masks.size(); ++n) {
      out[n] = 1 - intersection_over_union(masks[n], dynamic_cast<const Seen&>(observed).mask);
    }
  }
};

TEST_F(OwnPartsTest, AMetricOfItsOwnTracks) {
  TrackerOptions own = sampling(4);
  own.shape_metric = std::make_shared<Jaccard>();
  const std::vector<double> found = last_pose(own), truth = pose(5);
  EXPECT_NEAR(found[0], truth[0], 0.06);
  EXPECT_NEAR(found[1], truth[1], 0.06);
  EXPECT_NEAR(found[5], truth[5], 0.15);
}

// The same metric and the same silhouettes by the longer way: what is drawn, then compared.
TEST_F(OwnPartsTest, OwnMetricAndBackendGiveTheSameTrack) {
  TrackerOptions drawn = sampling();
  drawn.make_backend = make_reference_backend;
  drawn.shape_metric = std::make_shared<AreaMetric>(AreaMetric::Unit::kPixels);
  const auto fast = last_pose(sampling()), slow = last_pose(drawn);
  for (size_t d = 0; d < fast.size(); ++d) EXPECT_NEAR(fast[d], slow[d], 0.05) << d;
}

// Regenerated particles are drawn from the likely candidate alone, and the proposal is given the last estimate.
TEST_F(OwnPartsTest, RegenerationDrawsCandidatesByTheirDensity) {
  TrackerOptions own = options(SamplingOptions{.num_particles = kNumParticles,
                                               .resampling = "comb",
                                               .regenerate = 0.5,
                                               .regenerate_from = RegenerateFrom::kNetwork});
  const auto proposal = std::make_shared<Unlike>();
  own.proposal = proposal;
  Tracker tracker(own);
  const std::vector<double> first = step(tracker, 0).pose;
  step(tracker, 1);
  const StateBatch& particles = tracker.particles();
  EXPECT_GT(particles.col(0).maxCoeff(), 0.35);  // about the likely one, at 0.5 m
  EXPECT_LT(particles.col(0).maxCoeff(), 1);     // none about the unlikely one, at 1.5 m
  ASSERT_GE(proposal->contexts_.size(), 2u);
  EXPECT_EQ(proposal->contexts_.back().first, first);
  EXPECT_NEAR(proposal->contexts_.back().second, 1e-9 * kFrame_ns, 1e-12);
}

// A proposal that recognises nothing leaves the start to the common poses; one of the wrong size is refused.
TEST_F(OwnPartsTest, ProposalsAreChecked) {
  TrackerOptions own = options(FittedOptions{});
  own.initial_pose.reset();
  own.proposal = std::make_shared<Nothing>();
  Tracker tracker(own);
  EXPECT_EQ(step(tracker, 0).state, StepReport::State::kInitialised);
  own.proposal = std::make_shared<Wrong>();
  Tracker wrong(own);
  EXPECT_THROW(step(wrong, 0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
