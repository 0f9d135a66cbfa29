#include "apps/silpose/track_run.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "apps/silpose/subject_fit.h"
#include "sadb/store/memory_store.h"
#include "silpose/base/clock.h"
#include "silpose/base/job_line.h"
#include "silpose/exchange/mot.h"
#include "silpose/recording/track_recorder.h"
#include "silpose/track/open_questions.h"
#include "silpose/track/track_clip.h"
#include "silpose/track/tracker.h"

namespace silpose::app {
namespace {

// A checkpoint is written this often, less often where writing takes longer than a fiftieth of that.
constexpr double kLeastInterval_s = 2, kIntervalOverWriting = 50;

class TrackRun {
 public:
  TrackRun(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source, TrackWriter& writer,
           Console& console, TrackResume resume)
      : options_(options),
        tracker_options_(std::move(tracker)),
        source_(source),
        writer_(writer),
        console_(console),
        resume_(std::move(resume)),
        board_(std::make_shared<sadb::MemoryStore>()),
        // The masks are in files; kept in memory too, they would bound how long a clip may be.
        recorder_(board_, writer.body().skeleton, names_of(writer.cameras()), {.masks = false}) {}

  Result<Tracked> run() {
    tracked_.used = tracker_options_.resolved();
    const bool as_a_whole = *tracked_.used.smooth || *options_.fit_body;
    if (as_a_whole) writer_.keep_confidence();
    if (resume_.earlier) {
      if (Result<void> ready = restore(std::move(*resume_.earlier)); !ready) return ready.failure();
    }
    now_.seconds.background += source_.learning_s();
    const Result<void> done = as_a_whole ? track_whole() : track_online();
    if (!done) return done.failure();
    if (now_.num_frames == 0) {
      if (Console::interrupted()) return error("interrupted before the first frame");
      return error("{}: no frame between --start and --end", source_.video().name());
    }
    tracked_.interrupted = Console::interrupted();
    if (!now_.reports.empty()) {
      Result<TrackRecording> recording = read_recording(*board_);
      if (!recording) return recording.failure();
      tracked_.recording = std::move(*recording);
    }
    if (Result<void> done_writing = finish_writing(); !done_writing) return done_writing.failure();
    const Stopwatch writing;
    const Result<void> written = writer_.finish(tracked_.recording);
    if (!written) return written.failure();
    if (!has_opensim_coordinates(writer_.body().skeleton)) {
      tracked_.warnings.emplace_back("no motion.mot: the model's skeleton is not the human one");
    }
    now_.seconds.write += writing.seconds();
    const std::vector<std::string> open = ambiguities(now_.reports);
    tracked_.warnings.insert(tracked_.warnings.end(), open.begin(), open.end());
    tracked_.doubtful = doubtful_angles(now_.reports, writer_.body());
    tracked_.num_frames = now_.num_frames;
    tracked_.seconds = now_.seconds;
    tracked_.loop_s = earlier_loop_s_ + wall_.seconds();
    return std::move(tracked_);
  }

 private:
  static std::vector<std::string> names_of(const std::vector<PinholeCamera>& cameras) {
    std::vector<std::string> names;
    names.reserve(cameras.size());
    for (const PinholeCamera& camera : cameras) names.push_back(camera.name);
    return names;
  }

  Result<void> begin_at(int64_t frame_idx) {
    auto pose = read_initial_pose(options_, writer_.body().skeleton, frame_idx);
    if (!pose) return pose.failure();
    tracker_options_.initial_pose = std::move(*pose);
    return {};
  }

  // Restores the checkpoint. Reads the pictures of the frames that are done, without segmenting them.
  Result<void> restore(TrackCheckpoint earlier) {
    int64_t last = 0;
    for (int64_t n = 0; n < earlier.num_frames; ++n) {
      if (!console_.update("reading what is done", n, earlier.num_frames)) return error("interrupted");
      Result<std::optional<Frame>> frame = source_.skip();
      if (!frame) return frame.failure();
      if (!frame->has_value()) {
        return error("--resume: {} ends at frame {}, {} has {} of them", source_.video().name(), n,
                     resume_.folder.string(), earlier.num_frames);
      }
      last = (*frame)->index;
      if (n == 0) {
        if (Result<void> begun = begin_at(last); !begun) return begun;
      }
      if (n + 1 == earlier.num_frames && picture_checksum(**frame) != earlier.last_picture) {
        return error("--resume: frame {} of {} is not the one that {} was made of", last, source_.video().name(),
                     resume_.folder.string());
      }
      if (earlier.seen.empty()) continue;
      auto seen = writer_.read_masks(last, earlier.seen.at(static_cast<size_t>(n)));
      if (!seen) return seen.failure();
      for (size_t c = 0; c < seen->size(); ++c) (*seen)[c].ignored = source_.ignored(c);
      clip_.push_back({last, (*frame)->time_ns, std::move(*seen)});
    }
    source_.restore(earlier.source);
    writer_.restore_strips(std::exchange(earlier.strips, {}));
    now_ = std::move(earlier);
    earlier_loop_s_ = now_.loop_s;
    is_resumed_ = true;
    for (const StepReport& report : now_.reports) {
      if (Result<void> put = recorder_.put(report); !put) return put;
    }
    console_.message(fmt::format("{}: {} frames are done; resuming {}", resume_.folder.string(), now_.num_frames,
                                 place_of_resume(last)));
    return {};
  }

  // Where the checkpoint was written, for the user.
  [[nodiscard]] std::string place_of_resume(int64_t last_frame_idx) const {
    const bool is_whole = !now_.seen.empty();
    if (is_whole && !now_.reports.empty()) return "with the overlay";
    if (!now_.given_poses.empty())
      return now_.tracker.empty() ? "with the fit of the body" : "after the fit of the body";
    if (is_whole && !now_.tracker.empty()) return "in the pass over the whole clip";
    return fmt::format("after frame {}", last_frame_idx);
  }

  // Until all files of the frames so far are written.
  Result<void> finish_writing() {
    Result<void> done = writing_.finish();
    now_.seconds.write += writing_.take_seconds();
    return done;
  }

  Result<void> save(std::string tracker) {
    if (Result<void> done = finish_writing(); !done || source_.video().is_live()) return done;
    const Stopwatch writing;
    now_.tracker = std::move(tracker);
    now_.source = source_.state();
    now_.strips = writer_.strips();
    now_.loop_s = earlier_loop_s_ + wall_.seconds();
    Result<void> written = write_checkpoint(resume_.folder, resume_.made_with, now_);
    now_.seconds.write += writing.seconds();
    save_interval_s_ = std::max(kLeastInterval_s, kIntervalOverWriting * writing.seconds());
    since_save_ = {};
    return written;
  }
  [[nodiscard]] bool should_save() const { return Console::interrupted() || since_save_.seconds() > save_interval_s_; }

  // The next frame; nothing at the end or when asked to stop.
  Result<std::optional<Instant>> next(std::string_view progress) {
    if (!console_.update(progress, now_.num_frames, source_.num_expected())) return std::optional<Instant>();
    Result<std::optional<Instant>> instant = source_.next();
    if (!instant || !instant->has_value()) return instant;
    const Instant& now = **instant;
    if (now_.num_frames++ == 0) {
      if (const Result<void> begun = begin_at(now.frame.index); !begun) return begun.failure();
    }
    now_.seconds.decode += now.decode_s;
    now_.seconds.segment += now.segment_s;
    now_.last_picture = picture_checksum(now.frame);
    return instant;
  }

  Result<void> record(StepReport report) {
    StageSeconds& seconds = now_.seconds;
    seconds.start += report.seconds.start;
    seconds.propagate += report.seconds.propagate;
    seconds.likelihood += report.seconds.likelihood;
    seconds.resample += report.seconds.resample;
    report.observed.clear();
    Result<void> put = recorder_.put(report);
    now_.reports.push_back(std::move(report));
    return put;
  }

  Result<void> track_online() {
    std::optional<Tracker> tracker;
    if (is_resumed_) {
      tracker.emplace(tracker_options_);
      tracker->restore(now_.tracker);
    }
    while (true) {
      if (tracker) source_.expect(tracker->expected(1 / source_.video().fps()));
      Result<std::optional<Instant>> instant = next("tracking");
      if (!instant) return instant.failure();
      if (!instant->has_value()) break;
      Instant& now = **instant;
      if (!tracker) tracker.emplace(tracker_options_);
      StepReport report = tracker->step(now.observations, now.frame.index, now.frame.time_ns);
      const auto seen = std::make_shared<Instant>(std::move(now));
      Result<void> written = writing_.give([this, seen, pose = report.pose]() -> Result<void> {
        Result<void> masks = writer_.add_masks(seen->frame, seen->observations);
        // A film cannot be continued: it is drawn at the end.
        if (!masks || is_resumed_) return masks;
        return writer_.add_picture(std::move(seen->frame.images[0]), seen->frame.time_ns, pose);
      });
      if (!written) return written;
      if (Result<void> recorded = record(std::move(report)); !recorded) return recorded;
      if (!should_save()) continue;
      if (Result<void> saved = save(tracker->state()); !saved) return saved;
    }
    if (!tracker) return {};
    if (Console::interrupted() || is_resumed_) {
      if (Result<void> saved = save(tracker->state()); !saved) return saved;
    }
    return is_resumed_ ? draw() : Result<void>();
  }

  Result<void> track_whole() {
    while (true) {
      Result<std::optional<Instant>> instant = next("segmenting");
      if (!instant) return instant.failure();
      if (!instant->has_value()) break;
      Instant& now = **instant;
      std::vector<MaskSidecar>& sidecars = now_.seen.emplace_back();
      for (const Observation& seen : now.observations)
        sidecars.push_back({seen.trust, seen.keypoints_2d, seen.keypoints_3d});
      clip_.push_back({now.frame.index, now.frame.time_ns, now.observations});
      Result<void> written = writing_.give([this, seen = std::make_shared<Instant>(std::move(now))] {
        return writer_.add_masks(seen->frame, seen->observations);
      });
      if (!written) return written;
      if (!should_save()) continue;
      if (Result<void> saved = save({}); !saved) return saved;
    }
    if (clip_.empty()) return {};
    if (Result<void> saved = save(now_.tracker); !saved || Console::interrupted()) return saved;
    if (*options_.fit_body) {
      if (Result<void> fitted = fit_body_to_clip(); !fitted || Console::interrupted()) return fitted;
    }
    if (now_.reports.empty()) {
      if (Result<void> tracked = track_instants(); !tracked || Console::interrupted()) return tracked;
    }
    return draw();
  }

  // For tracking the clip as a whole; `saved_` has the result of saving.
  ClipResume clip_resume() {
    return {.state = now_.tracker, .keep = [this](const std::function<std::string()>& state) {
              now_.seconds.smooth += smoothing_.restart();
              if (saved_ && should_save()) saved_ = save(state());
            }};
  }

  Result<void> track_instants() {
    smoothing_.restart();
    const auto progress = [&](size_t done, size_t total) {
      return saved_ && console_.update("tracking", static_cast<int64_t>(done), static_cast<int64_t>(total));
    };
    std::vector<StepReport> reports = track_clip(tracker_options_, clip_, progress, clip_resume());
    // An incomplete pass is resumed from the checkpoint's state, not from its reports.
    if (!saved_ || (Console::interrupted() && reports.size() < clip_.size())) return saved_;
    double counted_s = 0;
    for (StepReport& report : reports) {
      const StepSeconds& of_step = report.seconds;
      counted_s += of_step.start + of_step.propagate + of_step.likelihood + of_step.resample;
      if (Result<void> recorded = record(std::move(report)); !recorded) return recorded;
    }
    now_.seconds.smooth += smoothing_.restart() - counted_s;
    return save({});
  }

  // Replaces the body by the subject's, as far as the clip determines it.
  Result<void> fit_body_to_clip() {
    smoothing_.restart();
    if (now_.given_poses.empty()) {
      std::vector<std::vector<double>> poses = poses_as_given(tracker_options_, clip_, console_, clip_resume());
      if (!saved_ || Console::interrupted()) return saved_;
      now_.given_poses = std::move(poses);
      if (Result<void> saved = save({}); !saved) return saved;
    }
    std::optional<BodyFit> fit = fit_subject(tracker_options_, clip_, now_.given_poses, console_);
    if (Console::interrupted()) return {};
    now_.seconds.smooth += smoothing_.restart();
    if (!fit) {
      tracked_.warnings.push_back("the body is as given: " + why_not_fitted(tracker_options_));
      return {};
    }
    tracker_options_ = options_after_fit(std::move(tracker_options_), *fit);
    tracked_.used.size_deviation = tracker_options_.size_deviation;
    writer_.set_fitted_body(fit->body);
    tracked_.body_fit = std::move(fit);
    return {};
  }

  // The overlay, in a second pass over the pictures.
  Result<void> draw() {
    const Result<Video*> again = source_.videos_again();
    if (!again) return again.failure();
    Video& video = **again;
    const auto total = std::ssize(now_.reports);
    for (int64_t drawn = 0; drawn < total && console_.update("writing", drawn, total);) {
      Result<std::optional<Frame>> frame = video.next();
      if (!frame) return frame.failure();
      if (!frame->has_value()) return error("{}: ended earlier when it was read again", video.name());
      const StepReport& report = now_.reports[static_cast<size_t>(drawn)];
      if ((*frame)->index < report.frame_idx) continue;
      Result<void> added =
          writing_.give([this, &report, picture = std::make_shared<ByteImage>(std::move((*frame)->images[0]))] {
            return writer_.add_picture(std::move(*picture), report.time_ns, report.pose);
          });
      if (!added) return added;
      ++drawn;
    }
    return finish_writing();
  }

  const TrackOptions& options_;
  TrackerOptions tracker_options_;
  ObservationSource& source_;
  TrackWriter& writer_;
  Console& console_;
  TrackResume resume_;
  std::shared_ptr<sadb::MemoryStore> board_;
  TrackRecorder recorder_;
  Tracked tracked_;
  TrackCheckpoint now_;
  std::vector<ClipInstant> clip_;  // tracked as a whole
  bool is_resumed_ = false;
  Result<void> saved_;
  Stopwatch wall_, since_save_, smoothing_;
  double earlier_loop_s_ = 0, save_interval_s_ = kLeastInterval_s;
  JobLine writing_;  // last: jobs use the rest
};

}  // namespace

Result<Tracked> track_video(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source,
                            TrackWriter& writer, Console& console, TrackResume resume) {
  return TrackRun(options, std::move(tracker), source, writer, console, std::move(resume)).run();
}

}  // namespace silpose::app
