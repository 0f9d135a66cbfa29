#include "silpose/offline/clip_passes.h"

#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/state_bytes.h"
#include "silpose/body/levels.h"

namespace silpose {
namespace {

constexpr double kPassShare = 0.35;  // [guess] of the whole work, one pass over the whole clip

}  // namespace

TrackerOptions options_of_pass(const TrackerOptions& options) {
  TrackerOptions pass = options;
  if (pass.fitted() != nullptr) pass.fitted()->smooth = false;
  if (pass.lod_vertices == 0 || pass.lod_vertices > kTrackingLevel) pass.lod_vertices = kTrackingLevel;
  return pass;
}

ClipPasses::ClipPasses(const TrackerOptions& options, const JudgedClip& clip, size_t first, size_t last)
    : options_(options), clip_(clip), first_(first), last_(last), hypotheses_(clip.size()) {
  check(first <= last && last < clip.size(), "ClipPasses: instants {} to {} of {}", first, last, clip.size());
}

void ClipPasses::start_at(size_t instant, double seconds) {
  check(instant >= first_ && instant <= last_, "ClipPasses: start {} is not within {} to {}", instant, first_, last_);
  start_ = instant;
  start_seconds_ = seconds;
}

bool ClipPasses::run(const std::function<bool(double share)>& proceed, const std::function<void()>& keep) {
  const size_t ends[kNumPasses][2] = {{start_, last_}, {last_, first_}, {first_, last_}};
  while (pass_ < kNumPasses) {
    if (!pass(ends[pass_][0], ends[pass_][1], proceed, keep)) return false;
  }
  return true;
}

// Tracks from one instant to another, backwards where that lies before, and keeps all hypotheses.
bool ClipPasses::pass(size_t from, size_t to, const std::function<bool(double share)>& proceed,
                      const std::function<void()>& keep) {
  begin_pass();
  const double direction = to >= from ? 1 : -1;
  const size_t count = (to >= from ? to - from : from - to) + 1;
  const double share = kPassShare * static_cast<double>(count) / static_cast<double>(clip_.size());
  while (step_ < count) {
    const size_t t = to >= from ? from + step_ : from - step_;
    const int64_t passed_ns = clip_[t].time_ns - clip_[from].time_ns;
    step(t, to >= from ? passed_ns : -passed_ns, direction);
    done_ += share / static_cast<double>(count);
    if (!proceed(done_)) return false;
    keep();
  }
  noise_ = tracker_->noise();
  tracker_.reset();
  step_ = 0;
  ++pass_;
  return true;
}

void ClipPasses::begin_pass() {
  if (tracker_) return;  // stopped within the pass
  TrackerOptions options = options_of_pass(options_);
  if (!last_pose_.empty()) options.initial_pose = last_pose_;
  tracker_.emplace(options);
  if (!resumed_tracker_.empty()) tracker_->restore(std::exchange(resumed_tracker_, {}));
}

void ClipPasses::step(size_t t, int64_t time_ns, double direction) {
  const ClipInstant& instant = clip_[t];
  const StepReport report = tracker_->step(instant.observations, instant.frame_idx, time_ns);
  ++step_;
  if (report.pose.empty()) return;
  last_pose_ = report.pose;
  const StateBatch& states = tracker_->particles();
  const auto D = static_cast<Eigen::Index>(options_.body->skeleton.num_dofs());
  for (Eigen::Index k = 0; k < states.rows(); ++k) {
    hypotheses_[t].poses.emplace_back(states.row(k).head(D).transpose());
    hypotheses_[t].velocities.emplace_back(direction * states.row(k).tail(D).transpose());
  }
}

std::string ClipPasses::state() const {
  return to_bytes(start_, pass_, step_, last_pose_, noise_, hypotheses_, done_, start_seconds_,
                  tracker_ ? tracker_->state() : std::string());
}

void ClipPasses::restore(std::string_view state) {
  check(from_bytes(state, start_, pass_, step_, last_pose_, noise_, hypotheses_, done_, start_seconds_,
                   resumed_tracker_) &&
            hypotheses_.size() == clip_.size() && start_ >= first_ && start_ <= last_ && pass_ <= kNumPasses &&
            step_ <= clip_.size(),
        "track_clip: not a state of this clip");
}

}  // namespace silpose
