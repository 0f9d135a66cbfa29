#include "silpose/offline/track_clip.h"

#include <algorithm>
#include <memory>
#include <string>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"
#include "silpose/body/levels.h"
#include "silpose/offline/clip_evidence.h"
#include "silpose/offline/clip_passes.h"
#include "silpose/offline/clip_path.h"
#include "silpose/offline/clip_report.h"
#include "silpose/offline/clip_start.h"
#include "silpose/offline/judged_clip.h"
#include "silpose/offline/smoother.h"
#include "silpose/track/tracker.h"

namespace silpose {
namespace {

// Tracks a clip with smoothing: chooses the start, passes over the clip, fits the best path of all hypotheses at once,
// and reports.
class ClipTracker {
 public:
  ClipTracker(const TrackerOptions& options, std::span<const ClipInstant> clip, const ClipProgress& progress,
              const ClipResume& resume)
      : options_(options), clip_(clip, options.cameras.size()), progress_(progress), resume_(resume) {
    options_.check();
    for (const ClipInstant& instant : clip) seen_.push_back(any_is_usable(instant.observations));
    const auto body = level_of_detail(options_.body, options_.lod_vertices);
    likelihood_ =
        std::make_unique<const CoverageLikelihood>(body, options_.cameras, kFittingRows, fitted_terms(options_));
    pose_prior_ = std::make_unique<const PosePrior>(body, options_.has_floor());
  }

  std::vector<StepReport> run() {
    const auto first_seen = std::ranges::find(seen_, true);
    if (first_seen == seen_.end()) return waiting_reports(clip_);
    const auto first = static_cast<size_t>(first_seen - seen_.begin());
    size_t last = clip_.size() - 1;
    while (!seen_[last]) --last;
    ClipPasses passes(options_, clip_, first, last);
    if (!start(passes)) return {};
    const auto keep = [&] {
      if (resume_.keep) resume_.keep([&] { return passes.state(); });
    };
    if (!passes.run([this](double share) { return proceed(share); }, keep)) {
      keep();
      return {};
    }
    std::vector<StepReport> reports = waiting_reports(clip_);
    if (!smooth(passes, std::span(reports).subspan(first, last - first + 1), first)) {
      keep();
      return {};
    }
    return reports;
  }

 private:
  // Reports progress: the instants are counted by the share of the whole work that is done. False once it was to stop.
  bool proceed(double share) {
    if (progress_ && !stopped_) {
      stopped_ = !progress_(static_cast<size_t>(share * static_cast<double>(clip_.size())), clip_.size());
    }
    return !stopped_;
  }

  // False where it was stopped.
  bool start(ClipPasses& passes) {
    if (!resume_.state.empty()) {
      passes.restore(resume_.state);
      return true;
    }
    const Stopwatch stopwatch;
    const size_t instant = choose_start(options_, clip_, seen_, [this] { return proceed(0); });
    passes.start_at(instant, stopwatch.seconds());
    return !stopped_;
  }

  // Smooths the best path through the hypotheses of instants `first` and later, and reports it. Without a hypothesis,
  // as no instant shows the kind of evidence that is used, the reports stay as they are. False where it was stopped.
  bool smooth(const ClipPasses& passes, std::span<StepReport> reports, size_t first) {
    const size_t count = reports.size();
    const auto hypotheses = passes.hypotheses().subspan(first, count);
    if (std::ranges::any_of(hypotheses, [](const Hypotheses& one) { return one.poses.empty(); })) return true;
    const auto seen = seen_.begin() + static_cast<ptrdiff_t>(first);
    ClipEvidence evidence{*likelihood_,
                          clip_.instants().subspan(first, count),
                          {seen, seen + static_cast<ptrdiff_t>(count)},
                          options_.evidence,
                          passes.noise()};
    const std::vector<std::vector<double>> energies = energies_of(evidence, hypotheses);
    std::vector<int64_t> times_ns;
    for (const ClipInstant* instant : evidence.instants) times_ns.push_back(instant->time_ns);
    const SmoothedPoses smoothed = smooth_poses(
        *likelihood_, *pose_prior_, evidence.instants, evidence.seen,
        best_path(options_.body->skeleton, options_.body->profile.acceleration, hypotheses, energies, times_ns),
        {.evidence = options_.evidence, .noise = evidence.noise}, [&] { return proceed(passes.share_done()); });
    if (stopped_) return false;
    evidence.noise = smoothed.noise;
    report_smoothed(options_, {evidence, smoothed, hypotheses, energies}, reports);
    reports.front().seconds.start = passes.start_seconds();
    return true;
  }

  TrackerOptions options_;
  JudgedClip clip_;
  const ClipProgress& progress_;
  const ClipResume& resume_;
  std::unique_ptr<const CoverageLikelihood> likelihood_;
  std::unique_ptr<const PosePrior> pose_prior_;
  std::vector<bool> seen_;  // [T]
  bool stopped_ = false;
};

}  // namespace

std::vector<StepReport> track_clip(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                   const ClipProgress& progress, const ClipResume& resume) {
  if (options.smooths() && !clip.empty()) return ClipTracker(options, clip, progress, resume).run();
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
