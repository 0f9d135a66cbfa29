// silpose track: from a clip to poses: observations in, tracker steps, each recorded; then the files of the result.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/observation_source.h"
#include "apps/silpose/option_file.h"
#include "apps/silpose/result_directory.h"
#include "apps/silpose/run_facts.h"
#include "apps/silpose/track_options.h"
#include "apps/silpose/track_writer.h"
#include "sadb/store/memory_store.h"
#include "silpose/base/clock.h"
#include "silpose/report/report_page.h"
#include "silpose/track/tracker.h"

namespace silpose::app {
namespace {

using Json = nlohmann::ordered_json;

// Seconds by stage; `background` is what was spent before the first frame, `start` on finding a starting pose.
struct StageSeconds {
  double background = 0, decode = 0, segment = 0, start = 0, propagate = 0, likelihood = 0, resample = 0, write = 0;

  [[nodiscard]] std::vector<std::pair<std::string, double>> list() const {
    return {{"background", background}, {"decode", decode},         {"segment", segment},   {"start", start},
            {"propagate", propagate},   {"likelihood", likelihood}, {"resample", resample}, {"write", write}};
  }
};

Json figure(double mean, double std) {
  if (std::isnan(mean)) return nullptr;
  return {{"mean", mean}, {"std", std}};
}

class TrackRun {
 public:
  TrackRun(const CLI::App& app, const TrackOptions& options, const CommonOptions& common, Console& console)
      : app_(app), options_(options), common_(common), console_(console) {}

  Result<Outcome> run() {
    Result<ResultDirectory> directory = ResultDirectory::create(options_.out);
    if (!directory) return directory.failure();
    Result<std::shared_ptr<const BodyModel>> body = choose_body(options_.model, console_);
    if (!body) return body.failure();
    body_ = *body;
    if (options_.init != "descent") {  // told before the clip is read
      const Result<std::vector<double>> pose = read_initial_pose(options_.init, body_->skeleton, 0);
      if (!pose) return pose.failure();
    }
    Result<std::vector<PinholeCamera>> cameras = prepare_cameras();
    if (!cameras) return cameras.failure();
    Result<ObservationSource> source = ObservationSource::open(options_.input, console_);
    if (!source) return source.failure();
    seconds_.background = source->learning_s();

    const Result<void> tracked = track(*source, *cameras, directory->path());
    if (!tracked) return tracked.failure();
    Result<Outcome> outcome = write_result(*source, *cameras, *directory);
    if (!outcome) return outcome.failure();
    if (interrupted_) {
      directory->keep();
      return outcome;
    }
    const Result<void> done = directory->commit();
    if (!done) return done.failure();
    return outcome;
  }

 private:
  // Cameras for the videos, before any background is learned.
  Result<std::vector<PinholeCamera>> prepare_cameras() {
    if (options_.input.videos.empty()) throw UsageError("VIDEO is missing");
    const Result<Video> video = open_video(options_.input.videos, options_.input.video_options());
    if (!video) return video.failure();
    std::vector<PictureSize> sizes;
    sizes.reserve(static_cast<size_t>(video->num_cameras()));
    for (int c = 0; c < video->num_cameras(); ++c) sizes.push_back({video->width(c), video->height(c)});
    Result<CameraChoice> choice = choose_cameras(options_.camera, sizes);
    if (!choice) return choice.failure();
    warnings_ = choice->warnings;
    return choice->cameras;
  }

  Result<void> track(ObservationSource& source, const std::vector<PinholeCamera>& cameras,
                     const std::filesystem::path& folder) {
    const Stopwatch wall;
    TrackWriter writer(folder, body_, cameras, source.video().fps());
    std::vector<std::string> names;
    names.reserve(cameras.size());
    for (const PinholeCamera& camera : cameras) names.push_back(camera.name);
    const auto board = std::make_shared<sadb::MemoryStore>();
    // The masks go to files as they come; kept in memory too, they would bound how long a clip may be.
    TrackRecorder recorder(board, body_->skeleton.name(), names, {.masks = false});
    std::optional<Tracker> tracker;
    int64_t frames = 0;
    while (!interrupted_) {
      const Result<std::optional<Instant>> next = source.next();
      if (!next) return next.failure();
      if (!next->has_value()) break;
      const Instant& instant = **next;
      if (!tracker) {
        Result<Tracker> made = make_tracker(options_, body_, cameras, common_.seed, instant.frame.index);
        if (!made) return made.failure();
        tracker.emplace(std::move(*made));
        used_ = tracker->options();
      }
      const StepReport report = tracker->step(instant.observations, instant.frame.index, instant.frame.time_ns);
      const Stopwatch writing;
      const Result<void> recorded = recorder.put(report);
      if (!recorded) return recorded.failure();
      const Result<void> written = writer.add_frame(instant, report);
      if (!written) return written.failure();
      seconds_.write += writing.seconds();
      seconds_.decode += instant.decode_s;
      seconds_.segment += instant.segment_s;
      seconds_.start += report.seconds.start;
      seconds_.propagate += report.seconds.propagate;
      seconds_.likelihood += report.seconds.likelihood;
      seconds_.resample += report.seconds.resample;
      interrupted_ = !console_.update("tracking", ++frames, source.num_expected());
    }
    interrupted_ = interrupted_ || Console::interrupted();
    if (frames == 0) {
      if (interrupted_) return error("interrupted before the first frame");
      return error("{}: no frame between --start and --end", source.video().name());
    }
    loop_s_ = wall.seconds();
    Result<TrackRecording> recording = read_recording(*board);
    if (!recording) return recording.failure();
    recording_ = std::move(*recording);
    return writer.write_recording(recording_);
  }

  Result<Outcome> write_result(const ObservationSource& source, const std::vector<PinholeCamera>& cameras,
                               const ResultDirectory& directory) {
    const RecordingSummary summary = summarise(recording_);
    const std::vector<std::string> of_input = source.warnings();
    warnings_.insert(warnings_.end(), of_input.begin(), of_input.end());
    if (summary.frames_tracked == 0) warnings_.push_back("no person was seen: there is no pose in this result");
    for (const std::string& warning : warnings_) console_.warning(warning);

    Outcome outcome;
    Json& run = outcome.json;
    run = run_facts(common_);
    run["model"] = options_.model;
    run["body"] = body_->name;
    run["frames"] = summary.frames;
    run["frames_tracked"] = summary.frames_tracked;
    run["frames_coasted"] = summary.frames_coasted;
    run["stages_s"] = Json::object();
    for (const auto& [stage, s] : seconds_.list()) run["stages_s"][stage] = s;
    run["frames_per_second"] = static_cast<double>(summary.frames) / loop_s_;
    run["visual_accuracy"] = figure(summary.visual_accuracy_mean, summary.visual_accuracy_std);
    run["background"] = source.background();
    run["cameras"] = Json::array();
    for (const PinholeCamera& camera : cameras) run["cameras"].push_back(camera.name);
    run["warnings"] = warnings_;
    run["out"] = options_.out;
    if (interrupted_) run["error"] = fmt::format("interrupted; {}.partial holds the frames done", options_.out);

    const std::filesystem::path& folder = directory.path();
    for (const Result<void>& written :
         {write_option_file(folder / "config.toml", app_, chosen_options(used_)), write_json(folder / "run.json", run),
          write_report(folder / "report.html", report_input(folder, source, summary))}) {
      if (!written) return written.failure();
    }
    outcome.interrupted = interrupted_;
    if (interrupted_) console_.error(run["error"].get<std::string>());
    outcome.text = fmt::format("{} frames, {} tracked, {} coasted; {:.1f} frames a second\n", summary.frames,
                               summary.frames_tracked, summary.frames_coasted, run["frames_per_second"].get<double>());
    if (summary.frames_tracked > 0) {
      outcome.text += fmt::format("visual accuracy {:.3f} \u00b1 {:.3f}\n", summary.visual_accuracy_mean,
                                  summary.visual_accuracy_std);
    }
    outcome.text += fmt::format("overlay: {0}/overlay.mp4\nreport:  {0}/report.html",
                                (interrupted_ ? directory.path() : directory.final_path()).string());
    return outcome;
  }

  [[nodiscard]] ReportInput report_input(const std::filesystem::path& folder, const ObservationSource& source,
                                         const RecordingSummary& summary) const {
    ReportInput report;
    report.title = std::filesystem::path(source.video().name()).filename().string();
    if (report.title.empty()) report.title = source.video().name();
    report.recording = &recording_;
    report.skeleton = &body_->skeleton;
    report.overlay_video = folder / "overlay.mp4";
    report.fps = source.video().fps();
    report.stages_s = seconds_.list();
    report.warnings = warnings_;
    report.facts = {{"Command", common_.command_line},
                    {"Version", SILPOSE_VERSION},
                    {"Machine", machine_name()},
                    {"Body", body_->name},
                    {"Silhouettes from", source.background()},
                    {"Camera", options_.camera.file.empty() ? "assumed" : options_.camera.file}};
    for (const auto& [name, value] : chosen_options(used_)) report.facts.emplace_back(name, value);
    report.facts.emplace_back("Seed", std::to_string(common_.seed));
    report.facts.emplace_back("Frames a second", fmt::format("{:.2f}", static_cast<double>(summary.frames) / loop_s_));
    return report;
  }

  const CLI::App& app_;
  const TrackOptions& options_;
  const CommonOptions& common_;
  Console& console_;
  std::shared_ptr<const BodyModel> body_;
  TrackRecording recording_;
  TrackerOptions used_;
  StageSeconds seconds_;
  std::vector<std::string> warnings_;
  double loop_s_ = 0;
  bool interrupted_ = false;
};

}  // namespace

Command add_track(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<TrackOptions>();
  CLI::App* const app = program.add_subcommand("track", "Track a person: VIDEO... --out DIR");
  add_track_options(*app, *options);
  return {app,
          [app, options, &common](Console& console) -> Result<Outcome> {
            if (options->out.empty()) throw UsageError("--out is missing");
            if (options->input.videos.empty()) throw UsageError("VIDEO is missing");
            return TrackRun(*app, *options, common, console).run();
          },
          &options->config};
}

}  // namespace silpose::app
