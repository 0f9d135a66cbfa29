// silpose track: from a clip to poses.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "apps/silpose/config_file.h"
#include "apps/silpose/shared_options.h"
#include "apps/silpose/table_options.h"
#include "silpose/base/option_error.h"
#include "silpose/session/clips_of_each.h"
#include "silpose/session/result_files.h"
#include "silpose/session/track_result.h"
#include "silpose/track/tracker_presets.h"
#include "silpose_commit.h"

namespace silpose::app {
namespace {

struct TrackCommand {
  TrackOptions track;
  std::string out, config;
  bool each = false, resume = false;
};

// What a track must have in common with the one it resumes: options, the cameras and the body, the program.
MadeWith made_with(OptionLines options, const TrackJob& job) {
  MadeWith all;
  for (auto& [key, value] : options) all.emplace_back(key == "video" ? "VIDEO" : "--" + key, std::move(value));
  for (auto& entry : silpose::made_with(job.cameras.cameras, *job.body)) all.push_back(std::move(entry));
  all.emplace_back("silpose", SILPOSE_VERSION " " SILPOSE_COMMIT);
  return all;
}

// What the terminal shows. `folder`: where the files are when the command ends.
std::string text_of(const SessionResult& result, const std::string& folder) {
  const RecordingSummary summary = summarise(result.recording);
  std::string text = fmt::format("{} frames, {} tracked, {} coasted; {:.1f} frames per second\n", result.num_frames,
                                 summary.frames_tracked, summary.frames_coasted, frames_per_second(result));
  if (summary.frames_tracked > 0) {
    text += fmt::format("visual accuracy {:.3f} \u00b1 {:.3f}\n", summary.visual_accuracy_mean,
                        summary.visual_accuracy_std);
  }
  if (result.recording.steps.empty()) return text + fmt::format("masks: {}", folder);
  text += fmt::format("overlay: {0}/overlay.mp4\nreport:  {0}/report.html", folder);
  if (result.body_fit) {
    text += fmt::format("\nbody:    {}/{}, {:.3f} m tall", folder, kFittedBodyFile, result.body->height_m);
  }
  return text;
}

Result<Outcome> track_one(const CLI::App& app, const TrackCommand& command, const CommonOptions& common,
                          Console& console) {
  Result<ResultDirectory> directory = ResultDirectory::create(command.out, command.resume);
  if (!directory) return directory.failure();
  if (command.resume && !command.each && !std::filesystem::exists(directory->path() / kCheckpointFile)) {
    console.message(fmt::format("{}: nothing to resume from", directory->path().string()));
  }
  const RunContext context = context_of(console);
  const Result<TrackJob> job = prepare_track(command.track, context);
  if (!job) return job.failure();
  const auto chosen = [&](const TrackerOptions& used) {
    auto options = chosen_options(job->options, used);
    if (command.each) options["video"] = command.track.input.videos.front();
    return options;
  };
  const auto masks = std::make_shared<MaskFiles>(directory->path(), job->cameras.cameras);
  const CheckpointPlace place{directory->path(), made_with(option_lines(app, chosen(job->tracker)), *job), masks};
  const Result<SessionResult> result = run_track(*job, place, command.resume, context);
  if (!result) return result.failure();

  const FinishedTrack finished{common.program, *job, *masks, *result, chosen(result->used), warnings_of(*job, *result)};
  for (const std::string& warning : finished.warnings) console.warning(warning);
  if (!result->recording.steps.empty()) {
    const Result<void> written = write_track_report(finished, directory->path());
    if (!written) return written.failure();
  }
  Outcome outcome;
  outcome.interrupted = result->stopped;
  outcome.json = facts_of(finished, command.out);
  outcome.text = text_of(*result, (result->stopped ? directory->path() : directory->final_path()).string());
  return deliver(*directory, app, finished.chosen, std::move(outcome), console);
}

// Every VIDEO is a clip of its own. One that fails does not stop the others: failures are reported when they occur, and
// once more at the end.
Result<Outcome> track_each(const CLI::App& app, const TrackCommand& command, const CommonOptions& common,
                           Console& console) {
  const std::vector<ClipOfEach> clips = clips_of_each(command.track, command.out);
  Outcome outcome;
  nlohmann::ordered_json& json = outcome.json["clips"] = nlohmann::ordered_json::array();
  std::string failures;
  size_t num_done = 0, num_there = 0;
  for (const ClipOfEach& clip : clips) {
    const std::string& video = clip.options.input.videos.front();
    nlohmann::ordered_json facts = {{"video", video}, {"out", clip.out.string()}};
    if (command.resume && is_whole_result(clip.out)) {
      ++num_there;
      json.push_back(std::move(facts));
      continue;
    }
    console.message(fmt::format("{} ({} of {})", video, json.size() + 1, clips.size()));
    TrackCommand one = command;
    one.track = clip.options;
    one.out = clip.out.string();
    Result<Outcome> tracked = track_one(app, one, common, console);
    if (Console::interrupted()) {
      outcome.interrupted = true;
      if (!tracked) console.error("interrupted; continue with --resume");
      break;
    }
    if (tracked) {
      ++num_done;
      facts["result"] = std::move(tracked->json);
    } else {
      const std::string& message = tracked.error().message;
      console.error(message);
      failures += fmt::format("\nfailed: {}: {}", video, message);
      facts["error"] = message;
    }
    json.push_back(std::move(facts));
  }
  outcome.failed = !failures.empty();
  outcome.text = fmt::format("{} of {} clips tracked", num_done, clips.size());
  if (num_there > 0) outcome.text += fmt::format(", {} were there already", num_there);
  outcome.text += failures;
  return outcome;
}

Result<Outcome> run_track(const CLI::App& app, TrackCommand command, const CommonOptions& common, Console& console) {
  if (command.out.empty()) throw_option_error("--out is missing");
  const std::string live = live_input(command.track.input.videos);
  if (command.resume && !live.empty()) throw_option_error("--resume: {} is live; give a recorded clip", live);
  command.track.seed = common.program.seed;
  command.track.check();
  return command.each ? track_each(app, command, common, console) : track_one(app, command, common, console);
}

// Beside the number of vertices: how else it can be chosen, and the first pose.
void add_level_and_start_options(CLI::App& app, TrackOptions& options) {
  app.add_option("--iou", options.level_iou,
                 "Compare the coarsest of the body's levels of detail whose silhouettes share this much with the whole "
                 "body's, on average, in place of --vertices")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes("--vertices");
  app.add_option("--init", options.init,
                 "First pose: descent; landmarks (the same, and it agrees with those that --segmenter learned finds); "
                 "auto (landmarks where some are found); or a poses.csv (its row of the first frame)")
      ->capture_default_str();
}

void add_fit_body_option(CLI::App& app, TrackOptions& options) {
  app.add_flag_function(
         "--fit-body,!--no-fit-body", [&options](int64_t count) { options.fit_body = count > 0; },
         "Of a recorded clip: track it, fit the body to the subject, track it again. Bones and girths with several "
         "cameras, or with one and --segmenter learned; with one and --floor the size (accurate: on where bones are)")
      ->group(fitted_option_table().group);
}

void add_tracker_options(CLI::App& app, TrackCommand& command) {
  TrackOptions& options = command.track;
  const std::vector<std::string_view> presets = preset_names();
  app.add_option(
         "--preset", options.preset,
         "default: hypotheses fitted online; accurate: more of them, the whole mesh, smoothed; thesis: two plain "
         "particle filters, root and pose")
      ->capture_default_str()
      ->check(CLI::IsMember(std::vector<std::string>(presets.begin(), presets.end())));
  add_table_options(app, tracker_option_table(), "Options", defaults_text,
                    {{"vertices", [&] { add_level_and_start_options(app, options); }}}, options.tracker);
  app.add_flag("--draw-floor", options.draw_floor,
               "Draw the floor y = 0 (1 m squares) and the footprints into the overlay: do camera and feet fit it?");
  add_config_option(app, command.config);
  add_table_options(app, fitted_option_table(), fitted_option_table().group, defaults_text,
                    {{"smooth", [&] { add_fit_body_option(app, options); }}}, options.tracker);
  add_table_options(app, sampling_option_table(), sampling_option_table().group, defaults_text, {}, options.tracker);
}

}  // namespace

Command add_track(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<TrackCommand>();
  CLI::App* const app = program.add_subcommand("track", "Track a person: VIDEO... --out DIR");
  add_input_options(*app, options->track.input);
  app->add_option("--out", options->out, "Directory for the result");
  app->add_flag("--each", options->each, "Every VIDEO is a separate clip, its result in DIR/NAME");
  app->add_flag(
      "--resume", options->resume,
      "Resume from what the same command, interrupted, left in DIR.partial; with --each, leave out clips that "
      "have a result already");
  add_model_option(*app, options->track.model);
  add_camera_options(*app, options->track.camera);
  add_table_options(*app, focal_option_table(), options->track.camera);
  add_tracker_options(*app, *options);
  return {app, [app, options, &common](Console& console) { return run_track(*app, *options, common, console); },
          &options->config};
}

}  // namespace silpose::app
