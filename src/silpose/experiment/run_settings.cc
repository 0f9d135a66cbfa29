#include "silpose/experiment/run_settings.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

constexpr double kMost = 1'000'000;
constexpr std::string_view kTrackerPrefix = "tracker_";

template <size_t N>
Words<std::string> words(const std::array<std::string_view, N>& names) {
  return words_from(names);
}

// Two members, as one pair of numbers.
Option<RunSettings> size_setting() {
  return {{.name = "size", .kind = OptionKind::kPair, .low = 16, .high = 8192, .help = "Width and height, pixels"},
          [](RunSettings& run, const OptionValue& value) {
            const auto& [width, height] = std::get<std::array<double, 2>>(value);
            run.width = static_cast<int>(width);
            run.height = static_cast<int>(height);
          },
          [](const RunSettings& run) -> std::optional<OptionValue> {
            return std::array<double, 2>{static_cast<double>(run.width), static_cast<double>(run.height)};
          }};
}

// One view, as an axis of plain values gives it.
Option<RunSettings> view_setting() {
  return {{.name = "view", .kind = OptionKind::kText, .help = "The only view"},
          [](RunSettings& run, const OptionValue& value) { run.views = {std::get<std::string>(value)}; },
          [](const RunSettings&) -> std::optional<OptionValue> { return std::nullopt; }};
}

nlohmann::ordered_json json_of(const GivenOptions& values) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [name, value] : values) {
    json[name] = std::visit([](const auto& of_type) { return nlohmann::ordered_json(of_type); }, value);
  }
  return json;
}

std::string line_of(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

const OptionTable<RunSettings>& run_setting_table() {
  static const OptionTable<RunSettings> kTable = {
      "Every run",
      {{"kind",
        &RunSettings::kind,
        {{"track", RunKind::kTrack}, {"track-clip", RunKind::kTrackClip}, {"keypoints", RunKind::kKeypoints}},
        "track: a rendered sequence is tracked; track-clip: a recorded clip; keypoints: no tracker runs, and a "
        "network's own keypoints of a recorded clip are scored. Not given: track, or track-clip with `clip`"},
       {"model", &RunSettings::model, "The body that is seen, as `--model`"},
       {"frames", &RunSettings::frames, between(0, kMost), "0: all of a file or clip, 80 of any other motion"},
       {"preset", &RunSettings::preset, words_from(preset_names()), "As `--preset`"},
       {"fit_body", &RunSettings::fit_body,
        "Track, fit the body to the subject, track again. Off unless given, unlike `silpose track --preset "
        "accurate`"}}};
  return kTable;
}

const OptionTable<RunSettings>& sequence_setting_table() {
  static const OptionTable<RunSettings> kTable = {
      "A rendered sequence",
      {{"motion", &RunSettings::motion, "As `silpose synth --motion`; with an extension a file under `--data`"},
       {"fps", &RunSettings::fps, between(0.1, 10000), "Frames per second"},
       {"amplitude_deg", &RunSettings::amplitude_deg, between(0, 180), "As `silpose synth --amplitude-deg`"},
       {"period_s", &RunSettings::period_s, between(0.01, 1e6), "As `silpose synth --period`"},
       {"range", &RunSettings::range, between(-1000, 1000),
        "Metres or degrees in which a `dof:` motion swings, in place of the DOF's limits"},
       {"views", &RunSettings::views, "One camera each: front, side or degrees"},
       view_setting(),
       size_setting(),
       {"focal_px", &RunSettings::focal_px, between(1, 1e6), "Focal length, pixels"},
       {"distance_m", &RunSettings::distance_m, between(0.5, 200), "Of the camera, metres"},
       {"mask_noise", &RunSettings::mask_noise,
        words(std::array<std::string_view, 5>{"none", "shadow", "edge", "limb", "hole"}), "What is wrong with masks"},
       {"mask_iou", &RunSettings::mask_iou, between(0.05, 0.999), "Of `edge`: with the true masks, on average"},
       {"faults_known", &RunSettings::faults_known, "The tracker ignores pixels that are wrong"},
       {"drawn_person", &RunSettings::drawn_person,
        "The subject is a random person of the model's stature, whose bones and girths differ as far as people's do"},
       {"keypoints", &RunSettings::keypoints,
        "Each mask comes with simulated network keypoints, whose directions are as far off as measured; half of the "
        "error is the same in every frame"}}};
  return kTable;
}

const OptionTable<RunSettings>& subject_setting_table() {
  static const OptionTable<RunSettings> kTable = {
      "The tracker of a rendered sequence",
      {{"body_height", &RunSettings::body_height, between(0.5, 2), "Of its body, over the model's"},
       {"body_weight", &RunSettings::body_weight, between(0.3, 3), "Of its body, over the model's"},
       {"start", &RunSettings::start, words(std::array<std::string_view, 2>{"tracker", "truth"}),
        "tracker: by itself; truth: the true first pose is given"}}};
  return kTable;
}

const OptionTable<RunSettings>& clip_setting_table() {
  static const OptionTable<RunSettings> kTable = {
      "A recorded clip",
      {{"clip", &RunSettings::clip, "Synchronised videos, one per camera"},
       {"camera", &RunSettings::camera, "Calibration file"},
       {"camera_names", &RunSettings::camera_names, "Which of its cameras, one per video; none: all, in their order"},
       {"truth", &RunSettings::truth, "Folder with the truth"},
       {"truth_above", &RunSettings::truth_above, between(-1000, 1000),
        "Of surfaces, only what lies above this y of the world counts, metres"},
       {"segmenter", &RunSettings::segmenter, words(std::array<std::string_view, 3>{"learned", "background", "masks"}),
        "masks: the videos are masks"},
       {"background", &RunSettings::background,
        "For `background`, one per video: auto, or an image of the empty scene"}}};
  return kTable;
}

const OptionInfo* tracker_option_of(std::string_view key) {
  const bool has_prefix = key.starts_with(kTrackerPrefix);
  const std::string name = with_dashes(has_prefix ? key.substr(kTrackerPrefix.size()) : key);
  if (const auto* option = tracker_option_table().find(name)) return &option->info;
  if (const auto* option = fitted_option_table().find(name)) return &option->info;
  if (const auto* option = sampling_option_table().find(name)) return &option->info;
  return nullptr;
}

bool is_motion_file(const std::string& motion) { return std::filesystem::path(motion).has_extension(); }

std::string settings_text(const RunSettings& settings) {
  GivenOptions values;
  run_setting_table().collect(settings, values);
  if (settings.is_recorded()) {
    clip_setting_table().collect(settings, values);
  } else {
    sequence_setting_table().collect(settings, values);
    subject_setting_table().collect(settings, values);
  }
  nlohmann::ordered_json json = json_of(values);
  json["tracker"] = json_of(settings.tracker);
  return line_of(json);
}

std::string sequence_text(const RunSettings& settings) {
  GivenOptions values = {{"model", settings.model}, {"frames", int64_t{settings.frames}}};
  sequence_setting_table().collect(settings, values);
  return line_of(json_of(values));
}

}  // namespace silpose
