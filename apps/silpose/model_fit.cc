#include "apps/silpose/model_fit.h"

#include <fmt/format.h>

#include <memory>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/body_facts.h"
#include "apps/silpose/body_fit_facts.h"
#include "apps/silpose/camera_choice.h"
#include "apps/silpose/input_options.h"
#include "silpose/offline/track_clip.h"
#include "silpose/track/tracker_presets.h"

namespace silpose::app {
namespace {

struct FitOptions {
  InputOptions input;
  CameraOptions camera;
  std::string model = "human", out;
};

Result<std::vector<ClipInstant>> read_clip_of(ObservationSource& source, Console& console) {
  std::vector<ClipInstant> clip;
  while (console.update("segmenting", std::ssize(clip), source.num_expected())) {
    Result<std::optional<Instant>> instant = source.next();
    if (!instant) return instant.failure();
    if (!instant->has_value()) break;
    clip.push_back({(*instant)->frame.index, (*instant)->frame.time_ns, std::move((*instant)->observations)});
  }
  return clip;
}

// The subject's own body. Errors: the clip does not determine it; interrupted.
Result<BodyFit> fit_to_clip(const TrackerOptions& tracker, const std::vector<ClipInstant>& clip,
                            const std::string& name, Console& console) {
  const auto progress = [&](size_t done, size_t total) {
    return console.update("tracking the body as given", static_cast<int64_t>(done), static_cast<int64_t>(total));
  };
  std::vector<std::vector<double>> poses;
  for (const StepReport& report : track_clip(options_before_fit(tracker), clip, progress)) poses.push_back(report.pose);
  const int64_t total = std::ssize(clip);
  std::optional<BodyFit> fit;
  if (!Console::interrupted()) {
    fit = fit_body(tracker, clip, poses, [&] { return console.update("fitting the body", total, total); });
  }
  if (Console::interrupted()) return error("interrupted: nothing is written");
  if (!fit) return error("{}: no body fitted: {}", name, why_not_fitted(tracker));
  return std::move(*fit);
}

Result<Outcome> run_fit(const FitOptions& options, const CommonOptions& common, Console& console) {
  if (options.input.videos.empty()) throw UsageError("VIDEO is missing");
  if (!options.camera.has_file()) {
    throw UsageError("--camera is missing: fitting a body needs calibrated cameras, a single one with its floor");
  }
  const std::filesystem::path folder = std::filesystem::absolute(options.out).parent_path();
  if (!std::filesystem::is_directory(folder))
    return error("--out {}: there is no folder {}", options.out, folder.string());
  const Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, console);
  if (!body) return body.failure();
  Result<Video> video = open_input(options.input);
  if (!video) return video.failure();
  const Result<CameraChoice> cameras = choose_cameras(options.camera, sizes_of(*video));
  if (!cameras) return cameras.failure();
  const auto source = observations_of(std::move(*video), options.input, console);
  if (!source) return source.failure();
  const std::string name = (*source)->video().name();
  const Result<std::vector<ClipInstant>> clip = read_clip_of(**source, console);
  if (!clip) return clip.failure();
  if (Console::interrupted()) return error("interrupted: nothing is written");
  if (clip->empty()) return error("{}: no frame between --start and --end", name);

  TrackerOptions tracker = accurate_preset();
  tracker.body = *body;
  tracker.cameras = cameras->cameras;
  tracker.size_deviation = size_deviation_of(options.model);
  tracker.seed = common.seed;
  tracker.landmarks = (*source)->finds_keypoints();
  const Result<BodyFit> fit = fit_to_clip(tracker, *clip, name, console);
  if (!fit) return fit.failure();

  std::vector<std::string> warnings = cameras->warnings;
  const std::vector<std::string> of_input = warnings_of(**source, options.input);
  warnings.insert(warnings.end(), of_input.begin(), of_input.end());
  if (fit->lengths.empty()) {
    warnings.emplace_back(
        "one camera without keypoints determines only the size of a subject on the floor, not bones or girths; "
        "--segmenter learned finds keypoints, and two cameras need none");
  }
  for (const std::string& warning : warnings) console.warning(warning);
  Result<Outcome> outcome = write_model(*fit->body, options.out);
  if (!outcome) return outcome.failure();
  outcome->json["fitted"] = facts_of(*fit);
  outcome->json["warnings"] = warnings;
  outcome->text = summary_of(*fit) + "\n" + outcome->text;
  return outcome;
}

}  // namespace

Command add_model_fit(CLI::App& model, const CommonOptions& common) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* const fit = model.add_subcommand(
      "fit",
      "A subject's own body: bones and girths by several cameras, or by one and keypoints; the size by a known floor");
  add_input_options(*fit, options->input);
  add_camera_options(*fit, options->camera);
  add_model_option(*fit, options->model);
  add_body_file_option(*fit, options->out);
  return {fit, [options, &common](Console& console) { return run_fit(*options, common, console); }};
}

}  // namespace silpose::app
