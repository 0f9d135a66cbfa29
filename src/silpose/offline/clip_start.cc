#include "silpose/offline/clip_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/body/levels.h"
#include "silpose/fit/initialisation.h"
#include "silpose/fit/landmark_proposal.h"
#include "silpose/offline/clip_passes.h"

namespace silpose {
namespace {

// [guess] How many instants are tried as the start, and how far apart they are at least, seconds.
constexpr size_t kNumStarts = 3;
constexpr double kStartsApart_s = 0.5;
constexpr double kCutOff = 0.5;  // [guess] how much a silhouette is worth that touches the border of the image

// How clearly silhouettes show the pose: limbs that stand out make an outline long for its area.
double clarity(const ClipInstant& instant) {
  double sum = 0;
  for (const Observation& o : instant.observations) {
    if (o.trust.nothing_found || o.box().empty()) continue;
    const double area = static_cast<double>(o.mask.count());
    sum += o.trust.overall * (o.trust.touches_border ? kCutOff : 1) * outline_length(o) / std::sqrt(area);
  }
  return sum;
}

// The instants that are seen, the clearest first.
std::vector<size_t> by_clarity(const JudgedClip& clip, const std::vector<bool>& seen) {
  std::vector<size_t> order;
  std::vector<double> score(clip.size(), 0.0);
  for (size_t t = 0; t < clip.size(); ++t) {
    if (seen[t]) order.push_back(t), score[t] = clarity(clip[t]);
  }
  std::ranges::stable_sort(order, std::greater<>{}, [&](size_t t) { return score[t]; });
  return order;
}

// Costs with and without keypoints cannot be compared. Frames with keypoints determine the pose better: where there are
// some, the others are left out.
void prefer_keypoints(const JudgedClip& clip, std::vector<size_t>& order) {
  const auto has_keypoints = [&](size_t t) {
    const auto& seen = clip[t].observations;
    return !seen[start_camera(seen)].keypoints_2d.empty();
  };
  if (std::ranges::any_of(order, has_keypoints)) {
    std::erase_if(order, [&](size_t t) { return !has_keypoints(t); });
  }
}

// The first kNumStarts of them that lie apart.
std::vector<size_t> spaced_out(const JudgedClip& clip, const std::vector<size_t>& order) {
  std::vector<size_t> starts;
  for (const size_t t : order) {
    const bool apart = std::ranges::all_of(starts, [&](size_t other) {
      return std::abs(static_cast<double>(clip[t].time_ns - clip[other].time_ns)) * 1e-9 >= kStartsApart_s;
    });
    if (apart) starts.push_back(t);
    if (starts.size() == kNumStarts) break;
  }
  return starts;
}

// The one of `starts` whose observations a pose explains best.
size_t best_explained(const TrackerOptions& options, const JudgedClip& clip, const std::vector<size_t>& starts,
                      const std::function<bool()>& proceed) {
  if (starts.size() == 1) return starts.front();
  // Passes start from scratch, so a coarse mesh will do to choose.
  const auto body = level_of_detail(options.body, options_of_pass(options).lod_vertices);
  const CoverageLikelihood likelihood(body, options.cameras, kFittingRows, fitted_terms(options));
  const std::shared_ptr<const Proposal> proposal = start_proposal(options);
  const CommonPoses common_poses(options.body->skeleton, options.body->profile);
  const PosePrior pose_prior(body, options.has_floor());
  double best = -std::numeric_limits<double>::infinity();
  size_t chosen = starts.front();
  const InitialisationOptions search{.seed = options.seed, .evidence = start_evidence(options)};
  for (const size_t t : starts) {
    if (!proceed()) break;
    Rng rng(options.seed, t);
    const auto& seen = clip[t].observations;
    Proposed proposed = proposal->propose({seen, options.cameras}, 0, rng);
    check_proposed(proposed, options.body->skeleton);
    if (proposed.poses.rows() == 0) proposed = common_poses.propose({seen, options.cameras}, 0, rng);
    const auto found = initialise(likelihood, pose_prior, seen, proposed.poses, search);
    if (found.front().log_likelihood > best) best = found.front().log_likelihood, chosen = t;
  }
  return chosen;
}

}  // namespace

size_t choose_start(const TrackerOptions& options, const JudgedClip& clip, const std::vector<bool>& seen,
                    const std::function<bool()>& proceed) {
  const auto first = std::ranges::find(seen, true);
  check(first != seen.end(), "choose_start: nothing is seen");
  if (options.initial_pose) return static_cast<size_t>(first - seen.begin());
  std::vector<size_t> order = by_clarity(clip, seen);
  if (start_evidence(options) != EvidenceKind::kSilhouette) prefer_keypoints(clip, order);
  return best_explained(options, clip, spaced_out(clip, order), proceed);
}

}  // namespace silpose
