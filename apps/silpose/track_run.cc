#include "apps/silpose/track_run.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "apps/silpose/subject_fit.h"
#include "sadb/store/memory_store.h"
#include "silpose/base/clock.h"
#include "silpose/exchange/mot.h"
#include "silpose/recording/track_recorder.h"
#include "silpose/track/track_clip.h"
#include "silpose/track/tracker.h"

namespace silpose::app {
namespace {

class TrackRun {
 public:
  TrackRun(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source, TrackWriter& writer,
           Console& console)
      : options_(options),
        tracker_options_(std::move(tracker)),
        source_(source),
        writer_(writer),
        console_(console),
        board_(std::make_shared<sadb::MemoryStore>()),
        // The masks are in files; kept in memory too, they would bound how long a clip may be.
        recorder_(board_, writer.body().skeleton.name(), names_of(writer.cameras()), {.masks = false}) {}

  Result<Tracked> run() {
    const Stopwatch wall;
    tracked_.used = tracker_options_.resolved();
    tracked_.seconds.background = source_.learning_s();
    const Result<void> done = *tracked_.used.smooth ? track_whole() : track_online();
    if (!done) return done.failure();
    if (tracked_.num_frames == 0) {
      if (Console::interrupted()) return error("interrupted before the first frame");
      return error("{}: no frame between --start and --end", source_.video().name());
    }
    tracked_.interrupted = Console::interrupted();
    if (is_recorded_) {
      Result<TrackRecording> recording = read_recording(*board_);
      if (!recording) return recording.failure();
      tracked_.recording = std::move(*recording);
    }
    const Stopwatch writing;
    const Result<void> written = writer_.finish(tracked_.recording);
    if (!written) return written.failure();
    if (!has_opensim_coordinates(writer_.body().skeleton)) {
      tracked_.warnings.emplace_back("no motion.mot: the model's skeleton is not the human one");
    }
    tracked_.seconds.write += writing.seconds();
    tracked_.loop_s = wall.seconds();
    return std::move(tracked_);
  }

 private:
  static std::vector<std::string> names_of(const std::vector<PinholeCamera>& cameras) {
    std::vector<std::string> names;
    names.reserve(cameras.size());
    for (const PinholeCamera& camera : cameras) names.push_back(camera.name);
    return names;
  }

  // The next frame, its masks written; nothing at the end or when asked to stop.
  Result<std::optional<Instant>> next(std::string_view progress) {
    if (!console_.update(progress, tracked_.num_frames, source_.num_expected())) return std::optional<Instant>();
    Result<std::optional<Instant>> instant = source_.next();
    if (!instant || !instant->has_value()) return instant;
    const Instant& now = **instant;
    if (tracked_.num_frames++ == 0) {
      auto pose = read_initial_pose(options_, writer_.body().skeleton, now.frame.index);
      if (!pose) return pose.failure();
      tracker_options_.initial_pose = std::move(*pose);
    }
    tracked_.seconds.decode += now.decode_s;
    tracked_.seconds.segment += now.segment_s;
    const Stopwatch writing;
    const Result<void> written = writer_.add_masks(now.frame, now.observations);
    tracked_.seconds.write += writing.seconds();
    if (!written) return written.failure();
    return instant;
  }

  Result<void> record(const StepReport& report) {
    StageSeconds& seconds = tracked_.seconds;
    seconds.start += report.seconds.start;
    seconds.propagate += report.seconds.propagate;
    seconds.likelihood += report.seconds.likelihood;
    seconds.resample += report.seconds.resample;
    is_recorded_ = true;
    return recorder_.put(report);
  }

  Result<void> track_online() {
    std::optional<Tracker> tracker;
    while (true) {
      Result<std::optional<Instant>> instant = next("tracking");
      if (!instant) return instant.failure();
      if (!instant->has_value()) return {};
      Instant& now = **instant;
      if (!tracker) tracker.emplace(tracker_options_);
      const StepReport report = tracker->step(now.observations, now.frame.index, now.frame.time_ns);
      const Stopwatch writing;
      if (Result<void> recorded = record(report); !recorded) return recorded;
      Result<void> drawn = writer_.add_picture(std::move(now.frame.images[0]), report.time_ns, report.pose);
      if (!drawn) return drawn;
      tracked_.seconds.write += writing.seconds();
    }
  }

  Result<void> track_whole() {
    std::vector<ClipInstant> clip;
    while (true) {
      Result<std::optional<Instant>> instant = next("segmenting");
      if (!instant) return instant.failure();
      if (!instant->has_value()) break;
      clip.push_back({(*instant)->frame.index, (*instant)->frame.time_ns, std::move((*instant)->observations)});
    }
    if (clip.empty() || Console::interrupted()) return {};
    const Stopwatch smoothing;
    if (fits_body(options_) && !fit_body_to(clip)) return {};
    const std::vector<StepReport> reports = track_clip(tracker_options_, clip, [&](size_t done, size_t total) {
      return console_.update("tracking", static_cast<int64_t>(done), static_cast<int64_t>(total));
    });
    double told_s = 0;
    for (const StepReport& report : reports) {
      if (Result<void> recorded = record(report); !recorded) return recorded;
      const StepSeconds& of_step = report.seconds;
      told_s += of_step.start + of_step.propagate + of_step.likelihood + of_step.resample;
    }
    tracked_.seconds.smooth = smoothing.seconds() - told_s;
    return draw(reports);
  }

  // From here on the body is the subject's, as far as the clip tells it. False: interrupted.
  bool fit_body_to(std::span<const ClipInstant> clip) {
    std::optional<BodyFit> fit = fit_subject(tracker_options_, clip, console_);
    if (Console::interrupted()) return false;
    if (!fit) {
      tracked_.warnings.push_back("the body is as given: " + why_not_fitted(tracker_options_.cameras.size()));
      return true;
    }
    tracker_options_.body = fit->body;
    writer_.set_fitted_body(fit->body);
    tracked_.body_fit = std::move(fit);
    return true;
  }

  // The overlay, in a second pass over the pictures.
  Result<void> draw(const std::vector<StepReport>& reports) {
    const Stopwatch writing;
    Result<Video> video = open_video(options_.input.videos, options_.input.video_options());
    if (!video) return video.failure();
    const auto total = std::ssize(reports);
    for (int64_t drawn = 0; drawn < total && console_.update("writing", drawn, total);) {
      Result<std::optional<Frame>> frame = video->next();
      if (!frame) return frame.failure();
      if (!frame->has_value()) return error("{}: ended earlier when it was read again", video->name());
      const StepReport& report = reports[static_cast<size_t>(drawn)];
      if ((*frame)->index < report.frame_idx) continue;
      Result<void> added = writer_.add_picture(std::move((*frame)->images[0]), report.time_ns, report.pose);
      if (!added) return added;
      ++drawn;
    }
    tracked_.seconds.write += writing.seconds();
    return {};
  }

  const TrackOptions& options_;
  TrackerOptions tracker_options_;
  ObservationSource& source_;
  TrackWriter& writer_;
  Console& console_;
  std::shared_ptr<sadb::MemoryStore> board_;
  TrackRecorder recorder_;
  bool is_recorded_ = false;
  Tracked tracked_;
};

}  // namespace

std::vector<std::pair<std::string, double>> StageSeconds::list() const {
  return {{"background", background}, {"decode", decode},       {"segment", segment},
          {"start", start},           {"propagate", propagate}, {"likelihood", likelihood},
          {"resample", resample},     {"smooth", smooth},       {"write", write}};
}

Result<Tracked> track_video(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source,
                            TrackWriter& writer, Console& console) {
  return TrackRun(options, std::move(tracker), source, writer, console).run();
}

}  // namespace silpose::app
