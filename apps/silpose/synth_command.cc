// silpose synth: a sequence with ground truth.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/config_file.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/option_error.h"
#include "silpose/exchange/clip_file.h"
#include "silpose/session/body_choice.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/result_directory.h"
#include "silpose/session/run_facts.h"
#include "silpose/synth/sequence_files.h"

namespace silpose::app {
namespace {

struct SynthOptions {
  std::string out, config, model = "human", motion = "static", size = "640x480", backdrop = "textured", noise = "none";
  std::vector<std::string> views;
  CameraOptions camera;
  int frames = 0, lead_in = 0;
  double fps = 30;
  std::optional<double> amplitude_deg, period_s, noise_iou;
  bool colour = false;
};

// Cameras of a file in place of those around the path.
Result<void> use_camera_file(const CameraOptions& options, SyntheticSequence& sequence) {
  Result<CameraChoice> chosen = choose_cameras(options, {});
  if (!chosen) return chosen.failure();
  sequence.cameras = chosen->cameras;
  const Eigen::Vector3d start(sequence.poses[0][0], sequence.poses[0][1], sequence.poses[0][2]);
  sequence.distance_m = (sequence.cameras[0].centre_in_world() - start).norm();
  return {};
}

Result<SyntheticSequence> make(const SynthOptions& options, const CommonOptions& common, Console& console,
                               Outcome& outcome) {
  SceneOptions scene;
  const Size size = parse_size("--size", options.size);
  scene.width = size.width;
  scene.height = size.height;
  scene.lead_in = options.lead_in;
  if (!options.views.empty()) scene.views.clear();
  for (const std::string& text : options.views) {
    const Result<View> view = parse_view(text);
    if (!view) throw_option_error("--view: {}", view.error().message);
    for (const View& other : scene.views) {
      if (other.name == view->name) throw_option_error("--view: {} is given twice", text);
    }
    scene.views.push_back(*view);
  }
  const Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, context_of(console));
  if (!body) return body.failure();
  const Result<SyntheticMotion> motion = make_motion(options.motion, **body,
                                                     {.num_frames = options.frames,
                                                      .fps = options.fps,
                                                      .amplitude_deg = options.amplitude_deg,
                                                      .period_s = options.period_s,
                                                      .seed = common.program.seed});
  if (!motion && !is_clip_file(options.motion)) throw_option_error("--motion: {}", motion.error().message);
  if (!motion) return motion.failure();
  if (motion->mean_residual_deg) {
    outcome.json["retargeting_deg"] = {{"mean", *motion->mean_residual_deg},
                                       {"max", motion->max_residual_deg.value_or(0)}};
  }
  Result<SyntheticSequence> sequence = make_sequence(*body, *motion, scene);
  if (!sequence || options.camera.file.empty()) return sequence;
  const Result<void> used = use_camera_file(options.camera, *sequence);
  if (!used) return used.failure();
  return sequence;
}

// The masks of each camera that are written in place of the true ones; none without noise.
Result<std::vector<DegradedMasks>> degrade(const SyntheticSequence& sequence, const SynthOptions& options,
                                           const CommonOptions& common, Outcome& outcome) {
  const Result<MaskFault> fault = parse_mask_fault(options.noise);
  if (!fault) throw_option_error("--noise: {}", fault.error().message);
  std::vector<DegradedMasks> masks;
  if (*fault == MaskFault::kNone) return masks;
  const MaskNoise noise{
      .fault = *fault, .iou = options.noise_iou.value_or(0.9), .outline = {}, .seed = common.program.seed};
  nlohmann::ordered_json iou = nlohmann::ordered_json::array();
  for (size_t c = 0; c < sequence.cameras.size(); ++c) {
    Result<DegradedMasks> of_camera = DegradedMasks::create(sequence, static_cast<int>(c), noise);
    if (!of_camera) return of_camera.failure();
    iou.push_back(of_camera->mean_iou());
    masks.push_back(std::move(*of_camera));
  }
  outcome.json["noise"] = {{"kind", options.noise}, {"mask_iou", iou}};
  return masks;
}

Result<Outcome> run_synth(const CLI::App& app, const SynthOptions& options, const CommonOptions& common,
                          Console& console) {
  if (options.out.empty()) throw_option_error("--out is missing");
  if (!options.camera.file.empty() && !options.views.empty()) throw_option_error("--view: not together with --camera");
  if (options.lead_in > 0 && !options.colour) throw_option_error("--lead-in: needs --colour");
  if (options.noise_iou && options.noise != "edge") throw_option_error("--noise-iou: needs --noise edge");
  Result<ResultDirectory> directory = ResultDirectory::create(options.out);
  if (!directory) return directory.failure();
  Outcome outcome;
  outcome.json = run_facts(common.program);
  const Result<SyntheticSequence> sequence = make(options, common, console, outcome);
  if (!sequence) return sequence.failure();

  std::optional<ColourOptions> colour;
  if (options.colour) {
    const Result<Backdrop> backdrop = parse_backdrop(options.backdrop);
    if (!backdrop) throw_option_error("--backdrop: {}", backdrop.error().message);
    colour = ColourOptions{.backdrop = *backdrop, .seed = common.program.seed};
  }
  const Result<std::vector<DegradedMasks>> masks = degrade(*sequence, options, common, outcome);
  if (!masks) return masks.failure();
  const Result<int> frames = write_sequence(directory->path(), *sequence, colour, &console, *masks);
  if (!frames) return frames.failure();

  outcome.interrupted = Console::interrupted();
  outcome.json["model"] = options.model;
  outcome.json["body"] = sequence->body->name;
  outcome.json["frames"] = *frames;
  outcome.json["lead_in"] = sequence->lead_in;
  outcome.json["fps"] = sequence->fps;
  outcome.json["cameras"] = nlohmann::ordered_json::array();
  for (const PinholeCamera& camera : sequence->cameras) outcome.json["cameras"].push_back(camera.name);
  outcome.json["distance_m"] = sequence->distance_m;
  outcome.json["out"] = options.out;
  outcome.text = fmt::format("{} frames in {}, camera at {:.2f} m", *frames, options.out, sequence->distance_m);
  return deliver(*directory, app, {}, std::move(outcome), console);
}

}  // namespace

Command add_synth(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<SynthOptions>();
  CLI::App* const app = program.add_subcommand("synth", "Render a sequence with ground truth");
  app->add_option("--out", options->out, "Directory for the sequence");
  add_model_option(*app, options->model);
  app->add_option("--motion", options->motion,
                  "FILE.bvh, FILE.txt (humanoid3d), static, dof:INDEX, circle, sway or random")
      ->capture_default_str();
  app->add_option("--amplitude-deg", options->amplitude_deg, "Amplitude of sway, circle and random")
      ->check(within(0, 180));
  app->add_option("--period", options->period_s, "Seconds per swing")->check(within(0.01, 1e6));
  app->add_option("--frames", options->frames, "Of the motion; default 80, or the whole of a motion file")
      ->check(CLI::Range(1, 1'000'000));
  app->add_option("--fps", options->fps, "Frames per second")->capture_default_str()->check(within(0.1, 10000));
  app->add_option("--view", options->views, "front, side, or degrees around the subject; repeat it for several cameras")
      ->allow_extra_args(false);
  app->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  add_camera_options(*app, options->camera);
  app->add_flag("--colour", options->colour, "Also a shaded video.mp4");
  app->add_option("--backdrop", options->backdrop, "The background: textured or green")
      ->capture_default_str()
      ->check(CLI::IsMember({"textured", "green"}));
  app->add_option("--lead-in", options->lead_in, "Frames of the video before the subject appears")
      ->check(CLI::Range(0, 100'000));
  app->add_option("--noise", options->noise,
                  "Faults of the masks written: none, shadow, edge, limb or hole; poses, joints and video stay true")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "shadow", "edge", "limb", "hole"}));
  app->add_option("--noise-iou", options->noise_iou,
                  "With --noise edge: mean intersection over union with the true masks; default 0.9")
      ->check(within(0.6, 0.99));
  add_config_option(*app, options->config);
  return {app, [app, options, &common](Console& console) { return run_synth(*app, *options, common, console); },
          &options->config};
}

}  // namespace silpose::app
