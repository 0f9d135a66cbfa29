#include "silpose/track/track_clip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/parallel.h"
#include "silpose/base/state_bytes.h"
#include "silpose/body/levels.h"
#include "silpose/track/body_error.h"
#include "silpose/track/initialisation.h"
#include "silpose/track/judged_clip.h"
#include "silpose/track/pose_estimate.h"
#include "silpose/track/smoother.h"
#include "silpose/track/tracker.h"
#include "silpose/track/visual_accuracy.h"

namespace silpose {
namespace {

using Eigen::VectorXd;

// How many instants are tried as the start, and how far apart they are at least, seconds.
constexpr size_t kNumStarts = 3;
constexpr double kStartsApart_s = 0.5;

// How clearly silhouettes show the pose: limbs that stand out make an outline long for its area.
double clarity(const ClipInstant& instant) {
  double sum = 0;
  for (const Observation& o : instant.observations) {
    if (o.trust.nothing_found || o.box().empty()) continue;
    const double area = static_cast<double>(o.mask.count());
    sum += o.trust.overall * (o.trust.touches_border ? 0.5 : 1) * outline_length(o) / std::sqrt(area);
  }
  return sum;
}

// The hypotheses of one or more passes at one instant: poses and velocities [K, 2 D], in clip time.
struct Possible {
  std::vector<VectorXd> poses, velocities;
  std::vector<double> energies;  // found once all passes are done

  static auto members(auto& p) { return std::tie(p.poses, p.velocities); }
};

class ClipTracker {
 public:
  ClipTracker(const TrackerOptions& options, std::span<const ClipInstant> clip, const ClipProgress& progress,
              const ClipResume& resume)
      : options_(options.resolved()),
        clip_(clip, options.cameras.size()),
        progress_(progress),
        resume_(resume),
        possible_(clip.size()),
        seen_(clip.size()) {
    options_.check();
    for (size_t t = 0; t < clip.size(); ++t) seen_[t] = any_is_usable(clip[t].observations);
    const auto body = level_of_detail(options_.body, *options_.lod_vertices);
    likelihood_ = std::make_shared<const CoverageLikelihood>(body, options_.cameras);
    plausibility_ = std::make_shared<const Plausibility>(body, *options_.floor);
  }

  std::vector<StepReport> run() {
    const Stopwatch stopwatch;
    const auto first = std::ranges::find(seen_, true);
    if (first == seen_.end()) return waiting(0, clip_.size());
    first_ = static_cast<size_t>(first - seen_.begin());
    last_ = clip_.size() - 1;
    while (!seen_[last_]) --last_;

    if (resume_.state.empty()) {
      start_ = clearest();
      start_seconds_ = stopwatch.seconds();
      if (stopped_) return {};
    } else {
      restore(resume_.state);
    }
    // From the clearest instant to the end, back to the beginning, and once more to the end. One pass may find what
    // another missed.
    const size_t ends[kNumPasses][2] = {{start_, last_}, {last_, first_}, {first_, last_}};
    while (pass_ < kNumPasses && !stopped_) pass(ends[pass_][0], ends[pass_][1]);
    if (stopped_) return report_and_stop();
    const SmoothedPoses smoothed = smooth_poses(
        *likelihood_, *plausibility_, clip_.instants().subspan(first_, last_ - first_ + 1),
        {seen_.begin() + static_cast<ptrdiff_t>(first_), seen_.begin() + static_cast<ptrdiff_t>(last_) + 1},
        best_path(), {.evidence = options_.evidence, .noise = noise_}, [&] { return proceed(); });
    if (stopped_) return report_and_stop();
    noise_ = smoothed.noise;
    return reports(smoothed);
  }

 private:
  // Reports progress: the instants are counted by the share of the whole work that is done.
  bool proceed(double done = -1) {
    if (done >= 0) done_ = done;
    if (progress_ && !stopped_) {
      stopped_ = !progress_(static_cast<size_t>(done_ * static_cast<double>(clip_.size())), clip_.size());
    }
    return !stopped_;
  }

  size_t clearest() {
    if (options_.initial_pose) return first_;
    std::vector<size_t> order;
    std::vector<double> score(clip_.size(), 0.0);
    for (size_t t = first_; t <= last_; ++t) {
      if (seen_[t]) order.push_back(t), score[t] = clarity(clip_[t]);
    }
    std::ranges::stable_sort(order, std::greater<>{}, [&](size_t t) { return score[t]; });
    // Costs with and without keypoints cannot be compared. Frames with keypoints determine the pose better.
    if (start_evidence(options_) != EvidenceKind::kSilhouette) {
      const auto has_keypoints = [&](size_t t) {
        const auto& seen = clip_[t].observations;
        return !seen[start_camera(seen)].keypoints_2d.empty();
      };
      if (std::ranges::any_of(order, has_keypoints)) {
        std::erase_if(order, [&](size_t t) { return !has_keypoints(t); });
      }
    }
    std::vector<size_t> starts;
    for (const size_t t : order) {
      const bool apart = std::ranges::all_of(starts, [&](size_t other) {
        return std::abs(static_cast<double>(clip_[t].time_ns - clip_[other].time_ns)) * 1e-9 >= kStartsApart_s;
      });
      if (apart) starts.push_back(t);
      if (starts.size() == kNumStarts) break;
    }
    // Passes start from scratch, so a coarse mesh will do to choose.
    const auto body = level_of_detail(options_.body, *options_of_pass(options_).lod_vertices);
    const CoverageLikelihood likelihood(body, options_.cameras);
    const Plausibility plausibility(body, *options_.floor);
    double best = -std::numeric_limits<double>::infinity();
    size_t chosen = starts.front();
    const InitialisationOptions search{.seed = options_.seed, .evidence = start_evidence(options_)};
    for (const size_t t : starts) {
      if (!proceed()) break;
      Rng rng(options_.seed, t);
      const auto& seen = clip_[t].observations;
      const size_t camera = start_camera(seen);
      const StateBatch candidates = start_proposal(options_, camera)->propose(seen[camera], 0, rng);
      const auto found = initialise(likelihood, plausibility, seen, candidates, search);
      if (found.front().log_likelihood > best) best = found.front().log_likelihood, chosen = t;
    }
    return chosen;
  }

  // Tracks from one instant to another, backwards where that lies before, and keeps all hypotheses.
  void pass(size_t from, size_t to) {
    TrackerOptions options = options_of_pass(options_);
    if (!last_pose_.empty()) options.initial_pose = last_pose_;
    tracker_.emplace(options);
    if (!resumed_tracker_.empty()) tracker_->restore(std::exchange(resumed_tracker_, {}));
    const double direction = to >= from ? 1 : -1;
    const size_t count = (to >= from ? to - from : from - to) + 1;
    const double share = kPassShare * static_cast<double>(count) / static_cast<double>(clip_.size());
    const auto D = static_cast<Eigen::Index>(options_.body->skeleton.num_dofs());
    while (step_ < count) {
      const size_t t = to >= from ? from + step_ : from - step_;
      const ClipInstant& instant = clip_[t];
      const int64_t time = to >= from ? instant.time_ns - clip_[from].time_ns : clip_[from].time_ns - instant.time_ns;
      const StepReport report = tracker_->step(instant.observations, instant.frame_idx, time);
      ++step_;
      if (!report.pose.empty()) {
        last_pose_ = report.pose;
        const StateBatch& states = tracker_->particles();
        for (Eigen::Index k = 0; k < states.rows(); ++k) {
          possible_[t].poses.emplace_back(states.row(k).head(D).transpose());
          possible_[t].velocities.emplace_back(direction * states.row(k).tail(D).transpose());
        }
      }
      if (!proceed(done_ + share / static_cast<double>(count))) return;
      keep_state();
    }
    noise_ = tracker_->noise();
    tracker_.reset();
    step_ = 0;
    ++pass_;
  }

  void keep_state() const {
    if (resume_.keep) resume_.keep([this] { return state(); });
  }
  std::vector<StepReport> report_and_stop() const {
    keep_state();
    return {};
  }

  [[nodiscard]] std::string state() const {
    return to_bytes(start_, pass_, step_, last_pose_, noise_, possible_, done_, start_seconds_,
                    tracker_ ? tracker_->state() : std::string());
  }
  void restore(std::string_view state) {
    check(from_bytes(state, start_, pass_, step_, last_pose_, noise_, possible_, done_, start_seconds_,
                     resumed_tracker_) &&
              possible_.size() == clip_.size() && start_ < clip_.size() && pass_ <= kNumPasses && step_ <= clip_.size(),
          "track_clip: not a state of this clip");
  }

  // Of all hypotheses, the sequence that fits best and moves most plausibly. Source: Viterbi's algorithm.
  std::vector<VectorXd> best_path() {
    const Skeleton& skeleton = options_.body->skeleton;
    std::vector<double> scale = options_.body->profile.acceleration;
    for (double& deviation : scale) deviation *= kTransitionScale;
    parallel_for(last_ - first_ + 1, 4, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(*likelihood_);
      for (size_t i = begin; i < end; ++i) {
        Possible& possible = possible_[first_ + i];
        possible.energies.assign(possible.poses.size(), 0.0);
        if (!seen_[first_ + i]) continue;
        const CoverageEvidence evidence = evidence_at(first_ + i);
        for (size_t k = 0; k < possible.poses.size(); ++k) {
          const VectorXd& pose = possible.poses[k];
          possible.energies[k] = likelihood_->energy(evidence, Blur::k4, view(pose), scratch);
        }
      }
    });
    const auto transition = [&](size_t t, size_t from, size_t to) {
      const double dt = static_cast<double>(clip_[t + 1].time_ns - clip_[t].time_ns) * 1e-9;
      const VectorXd velocity = 0.5 * (possible_[t].velocities[from] + possible_[t + 1].velocities[to]);
      double cost = 0;
      for (Eigen::Index d = 0; d < velocity.size(); ++d) {
        double off = possible_[t + 1].poses[to][d] - possible_[t].poses[from][d] - dt * velocity[d];
        if (skeleton.dofs()[static_cast<size_t>(d)].is_periodic) off = wrap_angle(off);
        const double ratio = off / scale[static_cast<size_t>(d)];
        cost += std::min(ratio * ratio, kTransitionCap);
      }
      return cost;
    };
    std::vector<std::vector<double>> cost(last_ + 1);
    std::vector<std::vector<size_t>> best(last_ + 1);
    for (size_t t = first_; t <= last_; ++t) {
      const size_t count = possible_[t].poses.size();
      cost[t].assign(possible_[t].energies.begin(), possible_[t].energies.end());
      best[t].assign(count, 0);
      if (t == first_) continue;
      for (size_t k = 0; k < count; ++k) {
        double least = std::numeric_limits<double>::infinity();
        for (size_t j = 0; j < cost[t - 1].size(); ++j) {
          const double value = cost[t - 1][j] + transition(t - 1, j, k);
          if (value < least) least = value, best[t][k] = j;
        }
        cost[t][k] += least;
      }
    }
    std::vector<VectorXd> path(last_ - first_ + 1);
    size_t k = static_cast<size_t>(std::ranges::min_element(cost[last_]) - cost[last_].begin());
    for (size_t t = last_;; --t) {
      path[t - first_] = possible_[t].poses[k];
      if (t == first_) break;
      k = best[t][k];
    }
    return path;
  }

  CoverageEvidence evidence_at(size_t t) const {
    CoverageEvidence evidence = likelihood_->prepare(clip_[t].observations, Blur::k4, Blur::k4, options_.evidence);
    evidence.set_noise(noise_);
    return evidence;
  }

  // Adds the variances [D], and those of landmarks [J + E], of the passes' hypotheses about the smoothed pose, weighed
  // by how well they fit. The spread is wide where the passes disagree and the evidence does not decide.
  void add_disagreement(size_t t, const CoverageEvidence& evidence, const StepReport& report,
                        CoverageLikelihood::Scratch& scratch, std::vector<double>& variance,
                        LandmarkVariances& landmark_variance) const {
    const BodyModel& body = *options_.body;
    const Possible& possible = possible_[t];
    const double own = likelihood_->energy(evidence, Blur::k4, report.pose, scratch);
    const double best = std::min(own, *std::ranges::min_element(possible.energies));
    double sum = std::exp(-0.5 * (own - best));
    std::vector<double> weights;
    for (const double energy : possible.energies) {
      weights.push_back(std::exp(-0.5 * (energy - best)) / static_cast<double>(kNumPasses));
      sum += weights.back();
    }
    const auto landmarks = landmark_positions(body, report.pose);
    for (size_t k = 0; k < weights.size(); ++k) {
      const double weight = weights[k] / sum;
      if (weight < 1e-6) continue;
      const VectorXd& pose = possible.poses[k];
      for (size_t d = 0; d < variance.size(); ++d) {
        double off = pose[static_cast<Eigen::Index>(d)] - report.pose[d];
        if (body.skeleton.dofs()[d].is_periodic) off = wrap_angle(off);
        variance[d] += weight * off * off;
      }
      const auto x = landmark_positions(body, view(pose));
      for (size_t l = 0; l < x.size(); ++l) {
        const Eigen::Vector3d off = x[l] - landmarks[l], root_off = x.front() - landmarks.front();
        landmark_variance.in_world[l] += weight * off.cwiseAbs2();
        landmark_variance.about_root[l] += weight * (off - root_off).cwiseAbs2();
      }
    }
  }

  std::vector<StepReport> waiting(size_t from, size_t to) const {
    std::vector<StepReport> reports;
    for (size_t t = from; t < to; ++t) reports.push_back(report_at(t));
    return reports;
  }

  StepReport report_at(size_t t) const {
    StepReport report{.frame_idx = clip_[t].frame_idx, .time_ns = clip_[t].time_ns, .exchanged = clip_.exchanged(t)};
    for (const Observation& observation : clip_[t].observations) {
      report.trust.push_back(observation.trust);
      report.observed.push_back(observation.mask);
    }
    return report;
  }

  std::vector<StepReport> reports(const SmoothedPoses& smoothed) const {
    const BodyModel& body = *options_.body;
    std::vector<StepReport> reports = waiting(0, clip_.size());
    std::vector<BatchRenderer> seen_by;
    for (const PinholeCamera& camera : options_.cameras) seen_by.emplace_back(options_.body, camera);
    const BodyError body_error(level_of_detail(body, kRankingLevel), options_.cameras, options_.size_deviation);
    parallel_for(smoothed.poses.size(), 4, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(*likelihood_), of_stretched(body_error.likelihood());
      for (size_t i = begin; i < end; ++i) {
        StepReport& report = reports[first_ + i];
        report.pose.assign(smoothed.poses[i].begin(), smoothed.poses[i].end());
        body.skeleton.clamp(report.pose);
        report.mode = report.pose;
        const VectorXd of_fit = smoothed.covariances[i].diagonal();
        std::vector<double> variance(of_fit.begin(), of_fit.end());
        LandmarkVariances of_landmarks = landmark_variances(body, report.pose, smoothed.covariances[i]);
        if (seen_[first_ + i]) {
          const CoverageEvidence evidence = evidence_at(first_ + i);
          add_disagreement(first_ + i, evidence, report, scratch, variance, of_landmarks);
          const auto from_body = body_error.variance(evidence, report.pose, of_stretched);
          for (size_t d = 0; d < variance.size(); ++d) variance[d] += from_body.dofs[d];
          of_landmarks += from_body.landmarks;
        }
        for (const double v : variance) report.spread.push_back(std::sqrt(std::max(v, 0.0)));
        for (const Eigen::Vector3d& v : of_landmarks.in_world) report.landmark_spread.emplace_back(v.cwiseSqrt());
        for (const Eigen::Vector3d& v : of_landmarks.about_root) {
          report.landmark_spread_about_root.emplace_back(v.cwiseSqrt());
        }
        report.effective_sample_size = 1;
        report.state = i == 0              ? StepReport::State::kInitialised
                       : seen_[first_ + i] ? StepReport::State::kTracked
                                           : StepReport::State::kCoasted;
        if (!seen_[first_ + i]) continue;
        report.visual_accuracy = visual_accuracy(seen_by, clip_[first_ + i].observations, report.pose);
      }
    });
    reports[first_].seconds.start = start_seconds_;
    return reports;
  }

  static constexpr size_t kNumPasses = 3;
  static constexpr double kPassShare = 0.35;     // of the whole work, one pass over the whole clip
  static constexpr double kTransitionScale = 4;  // times the profile's acceleration: hypotheses are fits, not truths
  static constexpr double kTransitionCap = 30;   // of one DOF

  TrackerOptions options_;
  JudgedClip clip_;
  const ClipProgress& progress_;
  const ClipResume& resume_;
  std::shared_ptr<const CoverageLikelihood> likelihood_;
  std::shared_ptr<const Plausibility> plausibility_;
  std::vector<Possible> possible_;  // [T]
  std::vector<bool> seen_;          // [T]
  std::vector<double> last_pose_, noise_;
  size_t first_ = 0, last_ = 0;
  size_t start_ = 0, pass_ = 0, step_ = 0;  // where the passes begin; the pass under way and how many steps it took
  std::optional<Tracker> tracker_;          // of the pass under way
  std::string resumed_tracker_;             // its state when an earlier call was stopped
  double done_ = 0, start_seconds_ = 0;
  bool stopped_ = false;
};

}  // namespace

TrackerOptions options_of_pass(const TrackerOptions& options) {
  TrackerOptions pass = options.resolved();
  pass.smooth = false;
  if (*pass.lod_vertices == 0 || *pass.lod_vertices > kTrackingLevel) pass.lod_vertices = kTrackingLevel;
  return pass;
}

std::vector<StepReport> track_clip(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                   const ClipProgress& progress, const ClipResume& resume) {
  const TrackerOptions resolved = options.resolved();
  if (*resolved.smooth && !clip.empty()) return ClipTracker(options, clip, progress, resume).run();
  Tracker tracker(options);
  std::vector<StepReport> reports;
  if (!resume.state.empty()) {
    std::string of_tracker;
    check(from_bytes(resume.state, reports, of_tracker) && reports.size() <= clip.size(),
          "track_clip: not a state of this clip");
    tracker.restore(of_tracker);
    for (size_t t = 0; t < reports.size(); ++t) {
      for (const Observation& observation : clip[t].observations) reports[t].observed.push_back(observation.mask);
    }
  }
  while (reports.size() < clip.size()) {
    const ClipInstant& instant = clip[reports.size()];
    reports.push_back(tracker.step(instant.observations, instant.frame_idx, instant.time_ns));
    const bool goes_on = !progress || progress(reports.size(), clip.size());
    if (resume.keep) resume.keep([&] { return to_bytes(reports, tracker.state()); });
    if (!goes_on) break;
  }
  return reports;
}

}  // namespace silpose
