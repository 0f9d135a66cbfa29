#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string_view>

#include "silpose/experiment/toml_entry.h"

namespace silpose {
namespace {

constexpr int kMost = 1'000'000;
using Setter = std::function<Result<void>(const TomlEntry&, RunSettings&)>;

Result<void> set_size(const TomlEntry& entry, RunSettings& run) {
  const auto size = pair_of(entry, 16, 8192);
  if (!size) return size.failure();
  run.width = static_cast<int>((*size)[0]);
  run.height = static_cast<int>((*size)[1]);
  return {};
}

// One view, as an axis of plain values gives it.
Result<void> set_view(const TomlEntry& entry, RunSettings& run) {
  const Result<std::string> view = text_of(entry);
  if (!view) return view.failure();
  run.views = {*view};
  return {};
}

const std::map<std::string, Setter, std::less<>>& setters() {
  static const std::map<std::string, Setter, std::less<>> kSetters = {
      {"model", [](const TomlEntry& e, RunSettings& run) { return take(text_of(e), run.model); }},
      {"motion", [](const TomlEntry& e, RunSettings& run) { return take(text_of(e), run.motion); }},
      {"frames", [](const TomlEntry& e, RunSettings& run) { return take(integer_of(e, 0, kMost), run.frames); }},
      {"fps", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.1, 10000), run.fps); }},
      {"amplitude_deg",
       [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0, 180), run.amplitude_deg); }},
      {"period_s", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.01, 1e6), run.period_s); }},
      {"range", [](const TomlEntry& e, RunSettings& run) { return take(pair_of(e, -1000, 1000), run.range); }},
      {"views", [](const TomlEntry& e, RunSettings& run) { return take(texts_of(e), run.views); }},
      {"view", set_view},
      {"size", set_size},
      {"focal_px", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 1, 1e6), run.focal_px); }},
      {"distance_m", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.5, 200), run.distance_m); }},
      {"mask_noise",
       [](const TomlEntry& e, RunSettings& run) {
         return take(word_of(e, {"none", "shadow", "edge", "limb", "hole"}), run.mask_noise);
       }},
      {"mask_iou", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.05, 0.999), run.mask_iou); }},
      {"faults_known", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.faults_known); }},
      {"drawn_person", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.drawn_person); }},
      {"keypoints", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.keypoints); }},
      {"fit_body", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.fit_body); }},
      {"clip", [](const TomlEntry& e, RunSettings& run) { return take(texts_of(e), run.clip); }},
      {"camera", [](const TomlEntry& e, RunSettings& run) { return take(text_of(e), run.camera); }},
      {"camera_names", [](const TomlEntry& e, RunSettings& run) { return take(texts_of(e), run.camera_names); }},
      {"truth", [](const TomlEntry& e, RunSettings& run) { return take(text_of(e), run.truth); }},
      {"truth_above",
       [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, -1000, 1000), run.truth_above); }},
      {"segmenter",
       [](const TomlEntry& e, RunSettings& run) {
         return take(word_of(e, {"learned", "background", "masks"}), run.segmenter);
       }},
      {"background", [](const TomlEntry& e, RunSettings& run) { return take(texts_of(e), run.background); }},
      {"evidence",
       [](const TomlEntry& e, RunSettings& run) {
         return take(word_of(e, {"silhouette", "landmarks", "both", "network"}), run.evidence);
       }},
      {"floor", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.floor); }},
      {"preset",
       [](const TomlEntry& e, RunSettings& run) {
         return take(word_of(e, {"default", "accurate", "thesis"}), run.preset);
       }},
      {"smooth", [](const TomlEntry& e, RunSettings& run) { return take(flag_of(e), run.smooth); }},
      {"hypotheses",
       [](const TomlEntry& e, RunSettings& run) { return take(integer_of(e, 1, 10000), run.hypotheses); }},
      {"particles", [](const TomlEntry& e, RunSettings& run) { return take(integer_of(e, 1, kMost), run.particles); }},
      {"layers", [](const TomlEntry& e, RunSettings& run) { return take(integer_of(e, 1, 1000), run.layers); }},
      {"vertices", [](const TomlEntry& e, RunSettings& run) { return take(integer_of(e, 0, kMost), run.vertices); }},
      {"body_height", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.5, 2), run.body_height); }},
      {"body_weight", [](const TomlEntry& e, RunSettings& run) { return take(number_of(e, 0.3, 3), run.body_weight); }},
      {"start",
       [](const TomlEntry& e, RunSettings& run) {
         return take(word_of(e, {"tracker", "truth"}), run.start);
       }},
  };
  return kSetters;
}

// Settings that only runs on a recorded clip have, and those that only runs on a rendered sequence have.
constexpr std::array<std::string_view, 8> kOfClips = {"clip",        "camera",     "camera_names", "truth",
                                                      "truth_above", "background", "segmenter",    "floor"};
constexpr std::array<std::string_view, 18> kOfSequences = {
    "motion",       "fps",         "amplitude_deg", "period_s",   "range",        "views",
    "view",         "size",        "focal_px",      "distance_m", "mask_noise",   "mask_iou",
    "faults_known", "body_height", "body_weight",   "start",      "drawn_person", "keypoints"};

}  // namespace

Result<void> check_settings(const GivenSettings& given, const RunSettings& run) {
  const bool is_recorded = run.is_recorded();
  for (const auto& [key, where] : given) {
    if (is_recorded && std::ranges::count(kOfSequences, key) > 0) {
      return error("{}: not together with clip: it is of rendered sequences", where);
    }
    if (!is_recorded && std::ranges::count(kOfClips, key) > 0) return error("{}: needs clip, a list of videos", where);
    if (!is_recorded && key == "evidence" && !run.keypoints) {
      return error("{}: needs clip, a list of videos, or keypoints = true", where);
    }
    if (key == "fit_body" && run.fit_body && run.evidence == "landmarks") {
      return error("{}: needs silhouettes; not with evidence = \"landmarks\"", where);
    }
  }
  if (!is_recorded && run.evidence == "network") return error("{}: network is of recorded clips", given.at("evidence"));
  if (!is_recorded) return {};
  const std::string& where = given.at("clip");
  const auto is_one_a_video = [&](const std::vector<std::string>& values) {
    return values.empty() || values.size() == run.clip.size();
  };
  if (run.camera.empty()) return error("{}: needs camera, a calibration file", where);
  if (run.truth.empty()) return error("{}: needs truth, a folder", where);
  if (!is_one_a_video(run.camera_names)) {
    return error("{}: {} camera_names for {} videos", where, run.camera_names.size(), run.clip.size());
  }
  if (!is_one_a_video(run.background)) {
    return error("{}: {} backgrounds for {} videos", where, run.background.size(), run.clip.size());
  }
  if (run.evidence == "network" && run.clip.size() > 1) {
    return error("{}: evidence = \"network\" is of one video: each camera has keypoints of its own", where);
  }
  if (run.segmenter != "learned" && (run.evidence == "landmarks" || run.evidence == "network")) {
    return error("{}: evidence = \"{}\" needs segmenter = \"learned\"", where, run.evidence);
  }
  return {};
}

Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run,
                            GivenSettings* given) {
  for (const auto& [key, node] : table) {
    const TomlEntry entry{node, fmt::format("{}.{}", where, key.str())};
    const auto setter = setters().find(key.str());
    if (setter == setters().end()) return error("{}: no such setting", entry.where);
    const Result<void> set = setter->second(entry, run);
    if (!set) return set.failure();
    if (given != nullptr) given->insert_or_assign(std::string(key.str()), entry.where);
  }
  return {};
}

}  // namespace silpose
