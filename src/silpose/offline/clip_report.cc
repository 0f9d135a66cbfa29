#include "silpose/offline/clip_report.h"

#include <utility>

#include "silpose/base/parallel.h"
#include "silpose/body/levels.h"
#include "silpose/fit/body_error.h"
#include "silpose/fit/pose_spread.h"
#include "silpose/offline/clip_passes.h"
#include "silpose/offline/clip_spread.h"
#include "silpose/render/silhouette.h"
#include "silpose/track/visual_accuracy.h"

namespace silpose {
namespace {

class SmoothedReporter {
 public:
  SmoothedReporter(const TrackerOptions& options, const SmoothedClip& clip)
      : clip_(clip),
        body_(*options.body),
        body_error_(level_of_detail(body_, kRankingLevel), options.cameras, options.size_deviation) {
    for (const PinholeCamera& camera : options.cameras) seen_by_.emplace_back(options.body, camera);
  }

  // Working memory, one per thread.
  struct Scratch {
    CoverageLikelihood::Scratch of_clip, of_stretched;
  };
  [[nodiscard]] Scratch scratch() const {
    return {CoverageLikelihood::Scratch(clip_.evidence.likelihood),
            CoverageLikelihood::Scratch(body_error_.likelihood())};
  }

  void fill(size_t t, Scratch& scratch, StepReport& report) const {
    const Eigen::VectorXd& pose = clip_.smoothed.poses[t];
    const bool is_seen = clip_.evidence.seen[t];
    report.pose.assign(pose.begin(), pose.end());
    body_.skeleton.clamp(report.pose);
    report.mode = report.pose;
    PoseSpread spread = spread_of(variances(t, report.pose, scratch));
    report.spread = std::move(spread.dofs);
    report.landmark_spread = std::move(spread.landmarks);
    report.landmark_spread_about_root = std::move(spread.landmarks_about_root);
    report.effective_sample_size = 1;
    report.state = t == 0    ? StepReport::State::kInitialised
                   : is_seen ? StepReport::State::kTracked
                             : StepReport::State::kCoasted;
    if (is_seen) {
      report.visual_accuracy = visual_accuracy(seen_by_, clip_.evidence.instants[t]->observations, report.pose);
    }
  }

 private:
  [[nodiscard]] PoseVariances variances(size_t t, std::span<const double> pose, Scratch& scratch) const {
    PoseVariances sum = pose_variances(body_, pose, clip_.smoothed.covariances[t]);
    if (!clip_.evidence.seen[t]) return sum;
    const CoverageEvidence evidence = clip_.evidence.at(t);
    const double energy = clip_.evidence.likelihood.energy(evidence, kClipBlur, pose, scratch.of_clip);
    const std::vector<double> weights = weights_beside(energy, clip_.energies[t], ClipPasses::kNumPasses);
    add_disagreement(body_, pose, clip_.hypotheses[t].poses, weights, sum);
    sum += body_error_.variance(evidence, pose, scratch.of_stretched);
    return sum;
  }

  const SmoothedClip& clip_;
  const BodyModel& body_;
  BodyError body_error_;
  std::vector<BatchRenderer> seen_by_;  // [C]
};

}  // namespace

std::vector<StepReport> waiting_reports(const JudgedClip& clip) {
  std::vector<StepReport> reports;
  for (size_t t = 0; t < clip.size(); ++t) {
    StepReport report{.frame_idx = clip[t].frame_idx, .time_ns = clip[t].time_ns, .exchanged = clip.exchanged(t)};
    for (const Observation& observation : clip[t].observations) {
      report.trust.push_back(observation.trust);
      report.observed.push_back(observation.mask);
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

void report_smoothed(const TrackerOptions& options, const SmoothedClip& clip, std::span<StepReport> reports) {
  const SmoothedReporter reporter(options, clip);
  parallel_for(reports.size(), 4, [&](size_t begin, size_t end) {
    auto scratch = reporter.scratch();
    for (size_t t = begin; t < end; ++t) reporter.fill(t, scratch, reports[t]);
  });
}

}  // namespace silpose
