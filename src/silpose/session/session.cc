#include "silpose/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/offline/track_clip.h"
#include "silpose/session/sink_queue.h"
#include "silpose/track/open_questions.h"
#include "silpose/track/tracker.h"

namespace silpose {
namespace {

// [guess] A checkpoint is written this often, less often where writing takes longer than a fiftieth of that.
constexpr double kLeastInterval_s = 2, kIntervalOverWriting = 50;

std::vector<std::string> names_of(const std::vector<PinholeCamera>& cameras) {
  std::vector<std::string> names;
  names.reserve(cameras.size());
  for (const PinholeCamera& camera : cameras) names.push_back(camera.name);
  return names;
}

}  // namespace

class Session::Impl {
 public:
  Impl(ObservationSource& source, SessionOptions options)
      : options_(std::move(options)), source_(source), sinks_(options_.sinks) {
    options_.tracker.check();
    result_.used = options_.tracker;
    result_.body = options_.tracker.body;
    is_whole_ = result_.used.smooths() || options_.fit_body;
    check(!is_whole_ || !source.video().is_live(), "Session: smoothing and fitting a body need a recorded clip");
    check(!options_.fit_body || options_.tracker.likelihoods.empty(),
          "Session: likelihoods of the program are of the body that was given, which is not the one that is fitted");
    check(!options_.checkpoint || !source.video().is_live(), "Session: a live camera cannot be resumed");
    check(!options_.checkpoint || std::ranges::count(options_.sinks, options_.checkpoint->masks) == 1,
          "Session: the masks of the checkpoint are not among the sinks");
    if (is_whole_ && options_.checkpoint) options_.checkpoint->masks->keep_confidence();
    now_.seconds.background = source_.learning_s();
  }

  Result<std::string> resume(Checkpoint earlier);
  Result<std::optional<StepReport>> next();
  Result<SessionResult> finish();

 private:
  bool update(std::string_view what, int64_t done, int64_t total) {
    if (!stopped_ && options_.progress) stopped_ = !options_.progress->update(what, done, total);
    return !stopped_;
  }

  Result<void> begin_at(int64_t frame_idx);
  Result<void> read_over_done(const Checkpoint& earlier, int64_t& last_idx);
  Result<void> give_reports_again();
  [[nodiscard]] std::string place_of_resume(int64_t last_frame_idx) const;
  Result<void> finish_writing();
  Result<void> save(std::string tracker);
  [[nodiscard]] bool should_save() const {
    return options_.checkpoint && (stopped_ || since_save_.seconds() > save_interval_s_);
  }
  Result<std::optional<Instant>> read(std::string_view progress);
  Result<void> record(StepReport report);

  Result<void> advance();
  Result<void> track_next();
  Result<void> end_online();

  Result<void> track_whole();
  Result<void> observe_whole();
  Result<void> track_instants();
  Result<void> fit_body_to_clip();
  std::vector<std::vector<double>> poses_as_given();
  std::optional<BodyFit> fitted_body();
  ClipResume clip_resume();
  Result<void> give_tracked_frames();

  SessionOptions options_;
  ObservationSource& source_;
  SessionResult result_;
  Checkpoint now_;
  std::optional<Tracker> tracker_;  // frame by frame
  std::vector<ClipInstant> clip_;   // tracked as a whole
  bool is_whole_ = false, is_resumed_ = false, stopped_ = false, ended_ = false, is_finished_ = false;
  std::optional<Error> failed_;  // reported again by every later call
  size_t num_given_ = 0;         // reports given by next()
  Result<void> saved_;
  Stopwatch wall_, since_save_, whole_clip_;
  double earlier_loop_s_ = 0, save_interval_s_ = kLeastInterval_s;
  SinkQueue sinks_;  // last: its calls use the rest
};

Result<void> Session::Impl::begin_at(int64_t frame_idx) {
  if (!options_.initial_pose) return {};
  auto pose = options_.initial_pose(frame_idx);
  if (!pose) return pose.failure();
  options_.tracker.initial_pose = std::move(*pose);
  return {};
}

// Reads the images of the frames that are done, without segmenting them.
Result<void> Session::Impl::read_over_done(const Checkpoint& earlier, int64_t& last_idx) {
  const std::string folder = options_.checkpoint->folder.string();
  for (int64_t n = 0; n < earlier.num_frames; ++n) {
    if (!update("reading what is done", n, earlier.num_frames)) return error("interrupted");
    Result<std::optional<Frame>> read = source_.skip();
    if (!read) return read.failure();
    if (!read->has_value()) {
      return error("{} ends at frame {}, {} has {} of them", source_.video().name(), n, folder, earlier.num_frames);
    }
    const Frame& frame = **read;
    last_idx = frame.index;
    if (n == 0) {
      if (Result<void> begun = begin_at(frame.index); !begun) return begun;
    }
    if (n + 1 == earlier.num_frames && image_checksum(frame) != earlier.last_image) {
      return error("frame {} of {} is not the one that {} was made of", frame.index, source_.video().name(), folder);
    }
    if (earlier.seen.empty()) continue;
    auto seen = options_.checkpoint->masks->read(frame, earlier.seen.at(static_cast<size_t>(n)));
    if (!seen) return seen.failure();
    for (size_t c = 0; c < seen->size(); ++c) {
      (*seen)[c].ignored = source_.ignored(c);
      (*seen)[c].time_ns = frame.time_ns;
    }
    clip_.push_back({frame.index, frame.time_ns, std::move(*seen)});
  }
  return {};
}

Result<std::string> Session::Impl::resume(Checkpoint earlier) {
  check(options_.checkpoint.has_value() && now_.num_frames == 0 && earlier.sinks.size() == options_.sinks.size(),
        "Session: cannot resume that");
  const double learning_s = now_.seconds.background;
  int64_t last_idx = 0;
  if (Result<void> read = read_over_done(earlier, last_idx); !read) return read.failure();
  source_.restore(earlier.source);
  for (size_t s = 0; s < options_.sinks.size(); ++s) options_.sinks[s]->restore(earlier.sinks[s]);
  now_ = std::move(earlier);
  now_.seconds.background += learning_s;
  earlier_loop_s_ = now_.loop_s;
  is_resumed_ = true;
  if (!is_whole_) {
    if (Result<void> given = give_reports_again(); !given) return given.failure();
  }
  return place_of_resume(last_idx);
}

Result<void> Session::Impl::give_reports_again() {
  for (const StepReport& report : now_.reports) {
    if (Result<void> given = sinks_.add_report(report); !given) return given;
  }
  return {};
}

std::string Session::Impl::place_of_resume(int64_t last_frame_idx) const {
  if (is_whole_ && !now_.reports.empty()) return "with the overlay";
  if (!now_.given_poses.empty()) return now_.tracker.empty() ? "with the fit of the body" : "after the fit of the body";
  if (is_whole_ && !now_.tracker.empty()) return "in the pass over the whole clip";
  return fmt::format("after frame {}", last_frame_idx);
}

// Until the sinks have received everything so far.
Result<void> Session::Impl::finish_writing() {
  Result<void> done = sinks_.finish();
  now_.seconds.write += sinks_.take_seconds();
  return done;
}

Result<void> Session::Impl::save(std::string tracker) {
  if (Result<void> done = finish_writing(); !done || !options_.checkpoint) return done;
  const Stopwatch writing;
  now_.tracker = std::move(tracker);
  now_.source = source_.state();
  now_.sinks.clear();
  for (const auto& sink : options_.sinks) now_.sinks.push_back(sink->state());
  now_.loop_s = earlier_loop_s_ + wall_.seconds();
  Result<void> written = write_checkpoint(options_.checkpoint->folder, options_.checkpoint->made_with, now_);
  now_.seconds.write += writing.seconds();
  save_interval_s_ = std::max(kLeastInterval_s, kIntervalOverWriting * writing.seconds());
  since_save_ = {};
  return written;
}

// The next instant; nullopt at the end or when asked to stop.
Result<std::optional<Instant>> Session::Impl::read(std::string_view progress) {
  if (!update(progress, now_.num_frames, source_.num_expected())) return std::optional<Instant>();
  Result<std::optional<Instant>> instant = source_.next();
  if (!instant) return instant;
  if (!instant->has_value()) {
    update(progress, now_.num_frames, now_.num_frames);  // the source ends early where it was asked to stop
    return instant;
  }
  const Instant& now = **instant;
  if (now_.num_frames++ == 0) {
    if (const Result<void> begun = begin_at(now.frame.index); !begun) return begun.failure();
  }
  now_.seconds.decode += now.decode_s;
  now_.seconds.segment += now.segment_s;
  now_.last_image = image_checksum(now.frame);
  return instant;
}

Result<void> Session::Impl::record(StepReport report) {
  now_.seconds.add(report.seconds);
  Result<void> given = sinks_.add_report(report);
  report.observed.clear();  // kept, they would bound how long a clip may be
  now_.reports.push_back(std::move(report));
  return given;
}

// Frame by frame: the next report, or the end.
Result<void> Session::Impl::track_next() {
  if (!tracker_ && is_resumed_) {
    tracker_.emplace(options_.tracker);
    tracker_->restore(now_.tracker);
  }
  if (tracker_) source_.expect(tracker_->expected(1 / source_.video().fps()));
  Result<std::optional<Instant>> instant = read("tracking");
  if (!instant) return instant.failure();
  if (!instant->has_value()) return end_online();
  Instant& now = **instant;
  if (!tracker_) tracker_.emplace(options_.tracker);
  const auto seen = std::make_shared<const std::vector<Observation>>(std::move(now.observations));
  StepReport report = tracker_->step(*seen, now.frame.index, now.frame.time_ns);
  const auto frame = std::make_shared<const Frame>(std::move(now.frame));
  if (Result<void> given = sinks_.add_observed(frame, seen); !given) return given;
  if (Result<void> recorded = record(std::move(report)); !recorded) return recorded;
  if (!is_resumed_ && sinks_.needs_tracked_frames()) {  // a film cannot be continued: it is drawn at the end
    if (Result<void> given = sinks_.add_tracked(frame, now_.reports.back()); !given) return given;
  }
  return should_save() ? save(tracker_->state()) : Result<void>();
}

Result<void> Session::Impl::end_online() {
  ended_ = true;
  if (tracker_ && (stopped_ || is_resumed_)) return save(tracker_->state());
  return {};
}

Result<void> Session::Impl::observe_whole() {
  while (true) {
    Result<std::optional<Instant>> instant = read("segmenting");
    if (!instant) return instant.failure();
    if (!instant->has_value()) break;
    Instant& now = **instant;
    std::vector<MaskSidecar>& sidecars = now_.seen.emplace_back();
    for (const Observation& seen : now.observations)
      sidecars.push_back({seen.trust, seen.keypoints_2d, seen.keypoints_3d});
    clip_.push_back({now.frame.index, now.frame.time_ns, now.observations});
    Result<void> given =
        sinks_.add_observed(std::make_shared<const Frame>(std::move(now.frame)),
                            std::make_shared<const std::vector<Observation>>(std::move(now.observations)));
    if (!given) return given;
    if (!should_save()) continue;
    if (Result<void> saved = save({}); !saved) return saved;
  }
  return clip_.empty() ? Result<void>() : save(now_.tracker);
}

Result<void> Session::Impl::track_whole() {
  ended_ = true;
  if (Result<void> observed = observe_whole(); !observed || stopped_ || clip_.empty()) return observed;
  if (options_.fit_body) {
    if (Result<void> fitted = fit_body_to_clip(); !fitted || stopped_) return fitted;
  }
  return now_.reports.empty() ? track_instants() : give_reports_again();
}

// For tracking the clip as a whole; `saved_` has the result of saving.
ClipResume Session::Impl::clip_resume() {
  return {.state = now_.tracker, .keep = [this](const std::function<std::string()>& state) {
            now_.seconds.smooth += whole_clip_.restart();
            if (saved_ && should_save()) saved_ = save(state());
          }};
}

Result<void> Session::Impl::track_instants() {
  whole_clip_.restart();
  const auto progress = [&](size_t done, size_t total) {
    return saved_ && update("tracking", static_cast<int64_t>(done), static_cast<int64_t>(total));
  };
  std::vector<StepReport> reports = track_clip(options_.tracker, clip_, progress, clip_resume());
  // An incomplete pass is resumed from the checkpoint's state, not from its reports.
  if (!saved_ || (stopped_ && reports.size() < clip_.size())) return saved_;
  double counted_s = 0;
  for (StepReport& report : reports) {
    const StepSeconds& of_step = report.seconds;
    counted_s += of_step.start + of_step.propagate + of_step.likelihood + of_step.resample;
    if (Result<void> recorded = record(std::move(report)); !recorded) return recorded;
  }
  now_.seconds.smooth += whole_clip_.restart() - counted_s;
  return save({});
}

// [T][D], fewer when stopped.
std::vector<std::vector<double>> Session::Impl::poses_as_given() {
  const auto progress = [&](size_t done, size_t total) {
    return update("tracking the body as given", static_cast<int64_t>(done), static_cast<int64_t>(total));
  };
  std::vector<std::vector<double>> poses;
  for (const StepReport& report : track_clip(options_before_fit(options_.tracker), clip_, progress, clip_resume())) {
    poses.push_back(report.pose);
  }
  return poses;
}

// Replaces the body by the subject's, as far as the clip determines it.
Result<void> Session::Impl::fit_body_to_clip() {
  whole_clip_.restart();
  if (now_.given_poses.empty()) {
    std::vector<std::vector<double>> poses = poses_as_given();
    if (!saved_ || stopped_) return saved_;
    now_.given_poses = std::move(poses);
    if (Result<void> saved = save({}); !saved) return saved;
  }
  const int64_t total = std::ssize(clip_);
  std::optional<BodyFit> fit =
      fit_body(options_.tracker, clip_, now_.given_poses, [&] { return update("fitting the body", total, total); });
  if (stopped_) return {};
  now_.seconds.smooth += whole_clip_.restart();
  if (!fit) {
    result_.warnings.push_back("the body is as given: " + why_not_fitted(options_.tracker));
    return {};
  }
  options_.tracker = options_after_fit(std::move(options_.tracker), *fit);
  result_.used = options_.tracker;
  result_.body = fit->body;
  for (const auto& sink : sinks_.sinks()) sink->set_body(fit->body);
  result_.body_fit = std::move(fit);
  return {};
}

// A pass over the frames for sinks that need them with their reports.
Result<void> Session::Impl::give_tracked_frames() {
  const Result<Video*> again = source_.rewound_video();
  if (!again) return again.failure();
  Video& video = **again;
  const auto total = std::ssize(now_.reports);
  for (int64_t given = 0; given < total && update("writing", given, total);) {
    Result<std::optional<Frame>> frame = video.next();
    if (!frame) return frame.failure();
    if (!frame->has_value()) return error("{}: ended earlier when it was read again", video.name());
    const StepReport& report = now_.reports[static_cast<size_t>(given)];
    if ((*frame)->index < report.frame_idx) continue;
    if (Result<void> added = sinks_.add_tracked(std::make_shared<const Frame>(std::move(**frame)), report); !added) {
      return added;
    }
    ++given;
  }
  return {};
}

// Tracks the next frame, or the whole clip. Nothing is done after a failure.
Result<void> Session::Impl::advance() {
  if (failed_) return *failed_;
  Result<void> tracked = is_whole_ ? track_whole() : track_next();
  if (!tracked) {
    failed_ = tracked.error();
    (void)sinks_.finish();  // they receive the frames before; the first failure is the one that is reported
  }
  return tracked;
}

Result<std::optional<StepReport>> Session::Impl::next() {
  if (failed_ || (num_given_ == now_.reports.size() && !ended_)) {
    if (Result<void> tracked = advance(); !tracked) return tracked.failure();
  }
  if (num_given_ == now_.reports.size()) return std::optional<StepReport>();
  return std::optional<StepReport>(now_.reports[num_given_++]);
}

Result<SessionResult> Session::Impl::finish() {
  check(!is_finished_, "Session: finished already");
  is_finished_ = true;
  while (failed_ || !ended_) {
    if (Result<void> tracked = advance(); !tracked) return tracked.failure();
  }
  if ((is_whole_ || is_resumed_) && !stopped_ && !now_.reports.empty() && sinks_.needs_tracked_frames()) {
    if (Result<void> given = give_tracked_frames(); !given) return given.failure();
  }
  if (Result<void> done = finish_writing(); !done) return done.failure();
  const Stopwatch writing;
  for (const auto& sink : sinks_.sinks()) {
    if (Result<void> finished = sink->finish(); !finished) return finished.failure();
  }
  now_.seconds.write += writing.seconds();
  result_.recording =
      recording_of(now_.reports, options_.tracker.body->skeleton.name(), names_of(result_.used.cameras));
  const std::vector<std::string> open = ambiguities(now_.reports);
  result_.warnings.insert(result_.warnings.end(), open.begin(), open.end());
  result_.doubtful = doubtful_angles(now_.reports, *result_.body);
  result_.num_frames = now_.num_frames;
  result_.seconds = now_.seconds;
  result_.loop_s = earlier_loop_s_ + wall_.seconds();
  result_.stopped = stopped_;
  return std::move(result_);
}

Session::Session(ObservationSource& source, SessionOptions options)
    : impl_(std::make_unique<Impl>(source, std::move(options))) {}
Session::~Session() = default;
Result<std::string> Session::resume(Checkpoint earlier) { return impl_->resume(std::move(earlier)); }
Result<std::optional<StepReport>> Session::next() { return impl_->next(); }
Result<SessionResult> Session::finish() { return impl_->finish(); }

}  // namespace silpose
