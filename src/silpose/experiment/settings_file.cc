#include <functional>
#include <map>

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

}  // namespace

Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run) {
  for (const auto& [key, node] : table) {
    const TomlEntry entry{node, fmt::format("{}.{}", where, key.str())};
    const auto setter = setters().find(key.str());
    if (setter == setters().end()) return error("{}: no such setting", entry.where);
    const Result<void> set = setter->second(entry, run);
    if (!set) return set.failure();
  }
  return {};
}

}  // namespace silpose
