#include "silpose/track/tracker.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"
#include "silpose/body/levels.h"
#include "silpose/filter/estimate.h"
#include "silpose/fit/initialisation.h"
#include "silpose/motion/common_poses.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/keypoint_axes.h"
#include "silpose/track/keypoint_sides.h"
#include "silpose/track/make_pose_filter.h"
#include "silpose/track/pose_filter.h"
#include "silpose/track/visual_accuracy.h"

namespace silpose {
namespace {

// [guess] After coasting for longer than this the subject may be anywhere, and the next good mask starts over.
constexpr double kLongestCoast_s = 1.0;

// [guess] A fit with a smaller overlap may be in a wrong basin. The pose is then searched for from scratch, first soon,
// then at growing intervals.
constexpr double kGoodAccuracy = 0.97;
constexpr double kFirstReinitialise_s = 0.12;
constexpr double kReinitialiseLater = 4;  // times the interval before [tuned on the runs of kReinitialiseShare]
// [guess] The interval is short again after the overlap falls below its recent mean, by more than its recent
// deviations. Bad masks alone do not start a search again and again.
constexpr double kLeastLost = 0.03, kLostDeviations = 3, kRecent_s = 1;
// Of one search; the next has other headings. kReinitialiseShare: of other limbs that are fitted finely. [tuned on
// human-start with masks of an IoU of 0.92, and on the first seeds of human-walk] together with kReinitialiseLater, for
// time at about the same accuracy (docs/notebook/speed.md).
constexpr int kReinitialiseHeadings = 3, kReinitialiseRounds = 2, kReinitialisePatience = 2;
constexpr double kReinitialiseShare = 0.5;
// [guess] A search turns the tracked body no further than this (cosine of 70 degrees), unless keypoints have faced
// elsewhere for about this long.
constexpr double kTurnedCosine = 0.34, kFacingMemory_s = 0.5;
constexpr double kFacingKnown_s = 3;  // [guess] after the last keypoints

// The joints that the first pair of limbs with contacts stands on, the right one first: feet.
std::optional<std::pair<int, int>> paired_contacts(const RigProfile& profile) {
  for (const auto& [right, left] : profile.limb_pairs) {
    const int a = profile.limbs[right].joints.back(), b = profile.limbs[left].joints.back();
    const auto& contacts = profile.contact_joints;
    if (std::ranges::count(contacts, a) > 0 && std::ranges::count(contacts, b) > 0) return std::pair(a, b);
  }
  return std::nullopt;
}

}  // namespace

struct Tracker::Impl {
  explicit Impl(const TrackerOptions& given)
      : options((given.check(), given)),
        common_poses(options.body->skeleton, options.body->profile),
        sides(given.cameras.size()) {
    body.fine = level_of_detail(options.body, options.lod_vertices);
    body.coarse = level_of_detail(options.body, kRankingLevel);
    body.likelihood =
        std::make_shared<const CoverageLikelihood>(body.fine, options.cameras, kFittingRows, fitted_terms(options));
    body.pose_prior = std::make_shared<const PosePrior>(body.fine, options.has_floor());
    for (const PinholeCamera& camera : options.cameras) {
      seen_by.emplace_back(options.body, camera);
      expected_by.emplace_back(body.coarse, camera);
    }
    filter = make_pose_filter(options, body);
    for_start = start_proposal(options);
  }

  // Starting poses for what is seen, `dt_s` after the last estimate: the given one, or by descent; the last estimate
  // competes, too.
  std::vector<StartingPose> starting_poses(std::span<const Observation> observations, double dt_s) const {
    if (options.initial_pose && last_pose.empty()) return {{*options.initial_pose, 0}};
    Rng rng(options.seed, static_cast<uint64_t>(steps));
    const Proposal& for_restart = options.proposal ? *options.proposal : common_poses;
    const Proposal& proposal = started ? for_restart : *for_start;
    const ProposalContext context{observations, options.cameras, last_pose, dt_s};
    Proposed proposed = proposal.propose(context, 0, rng);
    check_proposed(proposed, options.body->skeleton);
    if (proposed.poses.rows() == 0) proposed = common_poses.propose(context, 0, rng);
    StateBatch& candidates = proposed.poses;
    if (!last_pose.empty()) {
      candidates.conservativeResize(candidates.rows() + 1, Eigen::NoChange);
      candidates.bottomRows<1>() = Eigen::Map<const Eigen::RowVectorXd>(last_pose.data(), std::ssize(last_pose));
    }
    InitialisationOptions search{.seed = options.seed + static_cast<uint64_t>(steps),
                                 .evidence = start_evidence(options)};
    if (started) {
      search.num_headings = kReinitialiseHeadings;
      search.num_rounds = kReinitialiseRounds;
      search.patience = kReinitialisePatience;
      if (num_reinitialisations % 2 == 1) search.num_distant_rounds = 0;  // every other time
      search.share_fitted_finely = kReinitialiseShare;
      search.first_heading = kReinitialiseHeadings * num_reinitialisations;
    }
    return initialise(*body.likelihood, *body.pose_prior, observations, candidates, search);
  }

  // Whether any camera shows something to track by, of the kind of evidence that is used.
  bool has_evidence(std::span<const Observation> observations) const {
    if (options.evidence != EvidenceKind::kKeypoints) return any_is_usable(observations);
    for (size_t c = 0; c < observations.size(); ++c) {
      if (is_usable(observations[c]) &&
          make_keypoint_term(*options.body, options.cameras[c], observations[c], options.evidence)) {
        return true;
      }
    }
    return false;
  }

  // The observations without the keypoints of cameras whose network exchanged left and right. Empty where none did.
  std::vector<Observation> without_exchanged(std::span<const Observation> observations, double dt_s,
                                             double& most_exchanged) {
    std::vector<Observation> judged;
    for (size_t c = 0; c < observations.size(); ++c) {
      const double exchanged = sides[c].step(observations[c].keypoints_3d, dt_s);
      most_exchanged = std::max(most_exchanged, exchanged);
      if (exchanged <= kExchanged) continue;
      if (judged.empty()) judged.assign(observations.begin(), observations.end());
      judged[c].keypoints_3d = {};
      judged[c].keypoints_2d.clear();
    }
    return judged;
  }

  // From right to left across hips and shoulders of a pose, in the world; zero for a body without.
  Eigen::Vector3d line_across_pose(std::span<const double> pose) const {
    const Skeleton& skeleton = options.body->skeleton;
    const std::vector<Rigid3> joints = skeleton.forward_kinematics(pose);
    Eigen::Vector3d line = Eigen::Vector3d::Zero();
    for (const auto& [right, left] : options.body->profile.across) {
      line += joints[static_cast<size_t>(left)].translation - joints[static_cast<size_t>(right)].translation;
    }
    return line.stableNormalized();
  }

  // Tracks how well the directions agree in which the estimate and the keypoints face.
  void follow_facing(std::span<const Observation> observations, double dt_s, bool is_new) {
    const Eigen::Vector3d tracked = line_across_pose(last_pose);
    if (tracked.isZero()) return;
    for (size_t c = 0; c < observations.size(); ++c) {
      const std::optional<Eigen::Vector3d> seen = line_across(observations[c].keypoints_3d);
      if (!seen) continue;
      const double agreement =
          tracked.dot(world_from_keypoints(options.cameras[c], observations[c].keypoints_3d) * *seen);
      const double share = is_new ? 1 : std::min(dt_s / kFacingMemory_s, 1.0);
      facing_agreement += share * (agreement - facing_agreement);
      since_facing_s = 0;
      return;
    }
    since_facing_s += dt_s;
  }

  // Whether a pose faces elsewhere than the estimate, with which keypoints agreed until now.
  bool is_turned(const StartingPose& start) const {
    if (options.evidence == EvidenceKind::kSilhouette || since_facing_s > kFacingKnown_s) return false;
    const Eigen::Vector3d tracked = line_across_pose(last_pose);
    return !tracked.isZero() && facing_agreement > kTurnedCosine &&
           line_across_pose(start.pose).dot(tracked) < kTurnedCosine;
  }

  // The weights of hypotheses that face away from the estimate, and of those whose feet are exchanged against its own.
  void name_ambiguities(StepReport& report) const {
    if (options.fitted() == nullptr) return;
    const std::optional<std::pair<int, int>> feet = paired_contacts(options.body->profile);
    if (!feet) return;
    const ParticleSet& particles = filter->particles();
    const std::vector<double> weights = particles.weights();
    const auto feet_of = [&](std::span<const double> pose) {
      const std::vector<Rigid3> joints = options.body->skeleton.forward_kinematics(pose);
      return std::pair(joints[static_cast<size_t>(feet->first)].translation,
                       joints[static_cast<size_t>(feet->second)].translation);
    };
    const Eigen::Vector3d line = line_across_pose(report.pose);
    const auto [right_foot, left_foot] = feet_of(report.pose);
    for (size_t i = 1; i < weights.size(); ++i) {
      const std::span pose(particles.states.row(static_cast<Eigen::Index>(i)).data(), report.pose.size());
      const auto [other_right, other_left] = feet_of(pose);
      const double same = (right_foot - other_right).norm() + (left_foot - other_left).norm(),
                   crossed = (right_foot - other_left).norm() + (left_foot - other_right).norm();
      if (line.dot(line_across_pose(pose)) < 0) {
        report.turned += weights[i];
      } else if (crossed < 0.5 * same) {
        report.crossed += weights[i];
      }
    }
  }

  void summarise(std::span<const Observation> observations, StepReport& report) {
    report.pose = filter->estimate();
    const ParticleSet& particles = filter->particles();
    const auto best = particles.states.row(mode_index(particles.log_weights));
    report.mode.assign(best.data(), best.data() + options.body->skeleton.num_dofs());
    PoseSpread spread = filter->spread();
    report.spread = std::move(spread.dofs);
    report.landmark_spread = std::move(spread.landmarks);
    report.landmark_spread_about_root = std::move(spread.landmarks_about_root);
    if (report.state != StepReport::State::kCoasted) {
      report.visual_accuracy = visual_accuracy(seen_by, observations, report.pose);
    }
    last_pose = report.pose;
    name_ambiguities(report);
  }

  // Where the best hypothesis fits badly, adds hypotheses that are found from scratch.
  void reinitialise(std::span<const Observation> observations, double dt_s, StepReport& report) {
    since_reinitialised_s += dt_s;
    if (dt_s == 0) recent_accuracy = report.visual_accuracy, recent_deviation = 0;  // just started
    const double lost = recent_accuracy - report.visual_accuracy;
    if (lost > std::max(kLeastLost, kLostDeviations * recent_deviation)) reinitialise_interval_s = kFirstReinitialise_s;
    const double share = std::min(dt_s / kRecent_s, 1.0);
    recent_deviation += share * (std::abs(lost) - recent_deviation);
    recent_accuracy -= share * lost;
    if (options.fitted() == nullptr || report.visual_accuracy >= kGoodAccuracy ||
        since_reinitialised_s < reinitialise_interval_s)
      return;
    const Stopwatch stopwatch;
    std::vector<StartingPose> found = starting_poses(observations, 0);
    std::erase_if(found, [&](const StartingPose& start) { return is_turned(start); });
    if (!found.empty()) filter->add(found);
    ++num_reinitialisations;
    since_reinitialised_s = 0;
    reinitialise_interval_s *= kReinitialiseLater;
    report.seconds.start += stopwatch.seconds();
  }

  // The state between steps, but for the filter's.
  static auto members(auto& t) {
    return std::tie(t.last_pose, t.started, t.num_reinitialisations, t.reinitialise_interval_s, t.since_reinitialised_s,
                    t.recent_accuracy, t.recent_deviation, t.steps, t.last_time_ns, t.last_seen_ns, t.sides,
                    t.facing_agreement, t.since_facing_s);
  }

  TrackerOptions options;
  CommonPoses common_poses;
  TrackedBody body;
  std::vector<BatchRenderer> seen_by, expected_by;  // [C] the whole mesh, and a coarse one
  std::unique_ptr<PoseFilter> filter;
  std::shared_ptr<const Proposal> for_start;
  std::vector<double> last_pose;
  bool started = false;
  int num_reinitialisations = 0;
  double reinitialise_interval_s = kFirstReinitialise_s, since_reinitialised_s = 0, recent_accuracy = 0,
         recent_deviation = 0;
  int64_t steps = 0, last_time_ns = 0, last_seen_ns = 0;
  std::vector<KeypointSides> sides;  // [C]
  double facing_agreement = 1;       // cosine between where the estimate and the keypoints face
  double since_facing_s = 2 * kFacingKnown_s;
};

Tracker::Tracker(const TrackerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

StepReport Tracker::step(std::span<const Observation> given, int64_t frame_idx, int64_t time_ns) {
  Impl& t = *impl_;
  check(given.size() == t.options.cameras.size(), "Tracker: {} observations for {} cameras", given.size(),
        t.options.cameras.size());
  check(t.steps == 0 || time_ns > t.last_time_ns, "Tracker: time {} ns does not come after {} ns", time_ns,
        t.last_time_ns);
  StepReport report{.frame_idx = frame_idx, .time_ns = time_ns};
  for (const Observation& observation : given) {
    report.trust.push_back(observation.trust);
    report.observed.push_back(observation.mask);
  }
  const double dt_s = t.steps == 0 ? 0 : static_cast<double>(time_ns - t.last_time_ns) * 1e-9;
  const std::vector<Observation> judged = t.without_exchanged(given, dt_s, report.exchanged);
  const std::span<const Observation> observations = judged.empty() ? given : std::span(judged);
  const bool seen = t.has_evidence(observations);
  if (seen && t.started && static_cast<double>(time_ns - t.last_seen_ns) * 1e-9 > kLongestCoast_s) t.started = false;

  if (seen && !t.started) {
    const Stopwatch stopwatch;
    t.filter->start(t.starting_poses(observations, dt_s));
    t.started = true;
    t.reinitialise_interval_s = kFirstReinitialise_s;
    t.since_reinitialised_s = 0;
    report.state = StepReport::State::kInitialised;
    report.seconds.start += stopwatch.seconds();
    report.effective_sample_size = t.filter->step(observations, 0, report.seconds).effective_sample_size;
  } else if (seen) {
    report.state = StepReport::State::kTracked;
    report.effective_sample_size = t.filter->step(observations, dt_s, report.seconds).effective_sample_size;
  } else if (t.started) {
    report.state = StepReport::State::kCoasted;
    report.effective_sample_size = t.filter->coast(dt_s).effective_sample_size;
  }
  if (t.started) t.summarise(observations, report);
  const bool is_new = report.state == StepReport::State::kInitialised;
  if (t.started && seen) t.follow_facing(observations, dt_s, is_new);
  if (t.started && seen) t.reinitialise(observations, is_new ? 0 : dt_s, report);

  ++t.steps;
  t.last_time_ns = time_ns;
  if (seen) t.last_seen_ns = time_ns;
  return report;
}

std::vector<Mask> Tracker::expected(double dt_s) const {
  const Impl& t = *impl_;
  if (!t.started || t.last_seen_ns != t.last_time_ns) return {};
  const std::vector<double> pose = t.filter->predict(dt_s);
  std::vector<Mask> silhouettes;
  for (const BatchRenderer& renderer : t.expected_by) silhouettes.push_back(renderer.silhouette(pose));
  return silhouettes;
}

const TrackerOptions& Tracker::options() const { return impl_->options; }
const StateBatch& Tracker::particles() const { return impl_->filter->particles().states; }
std::span<const double> Tracker::log_weights() const { return impl_->filter->particles().log_weights; }

std::vector<double> Tracker::noise() const { return impl_->filter->noise(); }

std::string Tracker::state() const { return to_bytes(*impl_, impl_->filter->state()); }

void Tracker::restore(std::string_view state) {
  std::string of_filter;
  check(from_bytes(state, *impl_, of_filter), "Tracker: not a state of it");
  impl_->filter->restore(of_filter);
}

}  // namespace silpose
