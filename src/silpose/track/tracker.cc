#include "silpose/track/tracker.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"
#include "silpose/filter/estimate.h"
#include "silpose/motion/common_poses.h"
#include "silpose/render/silhouette.h"
#include "silpose/segment/background_segmenter.h"
#include "silpose/track/initialisation.h"
#include "silpose/track/observe.h"
#include "silpose/track/pose_filter.h"

namespace silpose {
namespace {

// The mesh that candidates are ranked by.
constexpr int kRankingVertices = 800, kRankingRows = 1;
// After coasting for longer than this the subject may be anywhere: the next good mask starts over.
constexpr double kLongestCoast_s = 1.0;

// A fit worse than this may be in a wrong basin: the pose is sought anew, first soon, then less and less often.
constexpr double kGoodAccuracy = 0.97;
constexpr double kFirstSeek_s = 0.12, kSeekLater = 4;  // times the interval before
// So it is where the fit gets worse than it was of late, by more than it goes up and down anyway: bad masks alone do
// not have it sought for ever.
constexpr double kLeastLost = 0.03, kLostDeviations = 3, kOfLate_s = 1;
constexpr int kSeekHeadings = 3, kSeekRounds = 2, kSeekPatience = 2;  // at a time, other headings each time
constexpr double kSeekShare = 0.5;                                    // of other limbs that are fitted finely

}  // namespace

struct Tracker::Impl {
  explicit Impl(const TrackerOptions& given) : options(given.resolved()) {
    options.check();
    const auto fine = level_of_detail(options.body, *options.lod_vertices);
    likelihoods.fine = std::make_shared<const CoverageLikelihood>(fine, options.cameras);
    likelihoods.plausibility = std::make_shared<const Plausibility>(fine, *options.floor);
    const auto coarse = level_of_detail(options.body, kRankingVertices);
    for (const PinholeCamera& camera : options.cameras) {
      seen_by.emplace_back(options.body, camera);
      expected_by.emplace_back(coarse, camera);
      if (!options.num_hypotheses) {
        likelihoods.renderers.push_back(std::make_shared<const BatchRenderer>(fine, camera));
      }
    }
    if (options.num_hypotheses) {
      likelihoods.coarse = std::make_shared<const CoverageLikelihood>(coarse, options.cameras, kRankingRows);
    }
    filter = make_pose_filter(options, likelihoods);
    for_start = start_proposal(options);
    if (!options.proposal) options.proposal = std::make_shared<const CommonPoses>(options.body->skeleton);
  }

  // Starting poses for what is seen: the given one, or by descent; the last estimate competes, too.
  std::vector<StartingPose> starting_poses(std::span<const Observation> observations) const {
    if (options.initial_pose && last_pose.empty()) return {{*options.initial_pose, 0}};
    Rng rng(options.seed, static_cast<uint64_t>(steps));
    const Proposal& proposal = started ? *options.proposal : *for_start;
    StateBatch candidates = proposal.propose(observations.front(), 0, rng);
    if (!last_pose.empty()) {
      candidates.conservativeResize(candidates.rows() + 1, Eigen::NoChange);
      candidates.bottomRows<1>() = Eigen::Map<const Eigen::RowVectorXd>(last_pose.data(), std::ssize(last_pose));
    }
    InitialisationOptions search{.seed = options.seed + static_cast<uint64_t>(steps)};
    if (options.landmarks) search.landmark_allowance = 0;
    if (started) {
      search.num_headings = kSeekHeadings;
      search.num_rounds = kSeekRounds;
      search.patience = kSeekPatience;
      if (num_seeks % 2 == 1) search.num_distant_rounds = 0;  // every other time
      search.share_fitted_finely = kSeekShare;
      search.first_heading = kSeekHeadings * num_seeks;
      // In some frame of a clip landmarks are wrong as a whole: they hinder what they contradict more than what is
      // tracked, and no more.
      if (options.landmarks) {
        search.landmark_allowance = landmark_cost(*options.body, options.cameras, observations, last_pose);
      }
    }
    return initialise(*likelihoods.fine, *likelihoods.plausibility, observations, candidates, search);
  }

  void summarise(std::span<const Observation> observations, StepReport& report) {
    report.pose = filter->estimate();
    const ParticleSet& particles = filter->particles();
    const auto best = particles.states.row(mode_index(particles.log_weights));
    report.mode.assign(best.data(), best.data() + options.body->skeleton.num_dofs());
    PoseSpread spread = filter->spread();
    report.spread = std::move(spread.dofs);
    report.landmark_spread = std::move(spread.landmarks);
    if (report.state != StepReport::State::kCoasted) {
      report.visual_accuracy = visual_accuracy(seen_by, observations, report.pose);
    }
    last_pose = report.pose;
  }

  // Where the best hypothesis fits badly, new ones from scratch compete with it.
  void seek_anew(std::span<const Observation> observations, double dt_s, StepReport& report) {
    since_seek_s += dt_s;
    if (dt_s == 0) accuracy_of_late = report.visual_accuracy, deviation_of_late = 0;  // just started
    const double lost = accuracy_of_late - report.visual_accuracy;
    if (lost > std::max(kLeastLost, kLostDeviations * deviation_of_late)) seek_interval_s = kFirstSeek_s;
    const double share = std::min(dt_s / kOfLate_s, 1.0);
    deviation_of_late += share * (std::abs(lost) - deviation_of_late);
    accuracy_of_late -= share * lost;
    if (!options.num_hypotheses || report.visual_accuracy >= kGoodAccuracy || since_seek_s < seek_interval_s) return;
    const Stopwatch stopwatch;
    filter->add(starting_poses(observations));
    ++num_seeks;
    since_seek_s = 0;
    seek_interval_s *= kSeekLater;
    report.seconds.start += stopwatch.seconds();
  }

  // All that goes from step to step but the filter's own.
  static auto members(auto& t) {
    return std::tie(t.last_pose, t.started, t.num_seeks, t.seek_interval_s, t.since_seek_s, t.accuracy_of_late,
                    t.deviation_of_late, t.steps, t.last_time_ns, t.last_seen_ns);
  }

  TrackerOptions options;
  Likelihoods likelihoods;
  std::vector<BatchRenderer> seen_by, expected_by;  // [C] the whole mesh, and a coarse one
  std::unique_ptr<PoseFilter> filter;
  std::shared_ptr<const Proposal> for_start;
  std::vector<std::unique_ptr<Segmenter>> segmenters;  // online, one a camera; made when first needed
  std::vector<double> last_pose;
  bool started = false;
  int num_seeks = 0;
  double seek_interval_s = kFirstSeek_s, since_seek_s = 0, accuracy_of_late = 0, deviation_of_late = 0;
  int64_t steps = 0, last_time_ns = 0, last_seen_ns = 0;
};

Tracker::Tracker(const TrackerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

StepReport Tracker::step(std::span<const Observation> observations, int64_t frame_idx, int64_t time_ns) {
  Impl& t = *impl_;
  check(observations.size() == t.options.cameras.size(), "Tracker: {} observations for {} cameras", observations.size(),
        t.options.cameras.size());
  check(t.steps == 0 || time_ns > t.last_time_ns, "Tracker: time {} ns does not come after {} ns", time_ns,
        t.last_time_ns);
  StepReport report{.frame_idx = frame_idx, .time_ns = time_ns};
  for (const Observation& observation : observations) {
    report.trust.push_back(observation.trust);
    report.observed.push_back(observation.mask);
  }
  const double dt_s = t.steps == 0 ? 0 : static_cast<double>(time_ns - t.last_time_ns) * 1e-9;
  const bool seen = any_has_a_say(observations);
  if (seen && t.started && static_cast<double>(time_ns - t.last_seen_ns) * 1e-9 > kLongestCoast_s) t.started = false;

  if (seen && !t.started) {
    const Stopwatch stopwatch;
    t.filter->start(t.starting_poses(observations));
    t.started = true;
    t.seek_interval_s = kFirstSeek_s;
    t.since_seek_s = 0;
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
  if (t.started && seen) t.seek_anew(observations, is_new ? 0 : dt_s, report);

  ++t.steps;
  t.last_time_ns = time_ns;
  if (seen) t.last_seen_ns = time_ns;
  return report;
}

StepReport Tracker::step(const Frame& frame) {
  Impl& t = *impl_;
  check(frame.images.size() == t.options.cameras.size(), "Tracker: {} images for {} cameras", frame.images.size(),
        t.options.cameras.size());
  const Stopwatch stopwatch;
  std::vector<Observation> observations;
  for (size_t c = 0; c < frame.images.size(); ++c) {
    if (t.segmenters.size() <= c) t.segmenters.push_back(make_online_segmenter(OnlineMixture::kMog2, {}));
    observations.push_back(observation_from(t.segmenters[c]->segment(frame.images[c], frame.index).value()));
  }
  const double segmenting = stopwatch.seconds();
  StepReport report = step(observations, frame.index, frame.time_ns);
  report.seconds.segment = segmenting;
  return report;
}

std::vector<Mask> Tracker::expected(double dt_s) const {
  const Impl& t = *impl_;
  if (!t.started || t.last_seen_ns != t.last_time_ns) return {};
  std::vector<double> pose = t.last_pose;
  const StateBatch& states = t.filter->particles().states;
  if (t.options.num_hypotheses) {
    const auto velocity = states.row(0).tail(std::ssize(pose));  // of the estimate, which is the best hypothesis
    for (size_t d = 0; d < pose.size(); ++d) pose[d] += dt_s * velocity[static_cast<Eigen::Index>(d)];
    t.options.body->skeleton.clamp(pose);
  }
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
