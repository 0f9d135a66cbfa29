#include <string_view>

#include "silpose/experiment/toml_entry.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// "tracker_sigma_deg".
std::string key_of_tracker(std::string_view option) { return fmt::format("tracker_{}", with_underscores(option)); }

// Sets the setting that `key` names; false where the table has none.
Result<bool> set_from(const OptionTable<RunSettings>& table, std::string_view key, const TomlEntry& entry,
                      RunSettings& run) {
  const Option<RunSettings>* const setting = table.find(key);
  if (setting == nullptr) return false;
  const Result<OptionValue> value = value_of(entry);
  if (!value) return value.failure();
  const Result<OptionValue> read = read_option(setting->info, *value);
  if (!read) return error("{}: {}", entry.where, read.error().message);
  setting->set(run, *read);
  return true;
}

// The same of an option of the tracker.
Result<bool> set_tracker(std::string_view key, const TomlEntry& entry, RunSettings& run) {
  const OptionInfo* const option = tracker_option_of(key);
  if (option == nullptr) return false;
  const Result<OptionValue> value = value_of(entry);
  if (!value) return value.failure();
  Result<OptionValue> read = read_option(*option, *value);
  if (!read) return error("{}: {}", entry.where, read.error().message);
  run.tracker.insert_or_assign(option->name, *std::move(read));
  return true;
}

Result<void> check_parts(const GivenSettings& given, const RunSettings& run) {
  for (const auto& [key, where] : given) {
    const bool of_sequence =
        sequence_setting_table().find(key) != nullptr || subject_setting_table().find(key) != nullptr;
    if (run.is_recorded() && of_sequence) {
      return error("{}: not together with clip: it is of rendered sequences", where);
    }
    if (!run.is_recorded() && clip_setting_table().find(key) != nullptr) {
      return error("{}: needs clip, a list of videos", where);
    }
    if (!run.is_recorded() && key == key_of_tracker("evidence") && !run.keypoints) {
      return error("{}: needs clip, a list of videos, or keypoints = true", where);
    }
  }
  return {};
}

Result<void> check_kind(const GivenSettings& given, const RunSettings& run) {
  if (!run.kind) return {};
  const std::string& where = given.at("kind");
  if (*run.kind == RunKind::kTrack && run.is_recorded()) {
    return error("{}: track is of rendered sequences; a clip's is track-clip", where);
  }
  if (*run.kind != RunKind::kTrack && !run.is_recorded()) return error("{}: needs clip, a list of videos", where);
  if (*run.kind == RunKind::kKeypoints && run.clip.size() > 1) {
    return error("{}: keypoints is of one video: each camera has keypoints of its own", where);
  }
  if (*run.kind == RunKind::kKeypoints && run.segmenter != "learned") {
    return error("{}: keypoints needs segmenter = \"learned\"", where);
  }
  return {};
}

Result<void> check_tracker(const GivenSettings& given, const RunSettings& run) {
  if (const std::optional<RefusedOption> refused = refused_option(run.preset, run.tracker)) {
    const std::string name = refused->name.substr(0, refused->name.find(' '));  // without its value
    return error("{}: {}", given.at(key_of_tracker(name)), refused->why);
  }
  const auto evidence = run.tracker.find("evidence");
  const bool by_keypoints = evidence != run.tracker.end() && evidence->second == OptionValue(std::string("landmarks"));
  if (!by_keypoints) return {};
  if (run.fit_body && given.contains("fit_body")) {
    return error("{}: needs silhouettes; not with evidence = \"landmarks\"", given.at("fit_body"));
  }
  if (run.is_recorded() && run.segmenter != "learned") {
    return error("{}: evidence = \"landmarks\" needs segmenter = \"learned\"", given.at(key_of_tracker("evidence")));
  }
  return {};
}

Result<void> check_clip(const GivenSettings& given, const RunSettings& run) {
  if (!run.is_recorded()) return {};
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
  return {};
}

}  // namespace

Result<void> check_settings(const GivenSettings& given, const RunSettings& run) {
  for (const auto check : {check_parts, check_kind, check_tracker, check_clip}) {
    const Result<void> checked = check(given, run);
    if (!checked) return checked;
  }
  return {};
}

Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run,
                            GivenSettings* given) {
  for (const auto& [toml_key, node] : table) {
    std::string key(toml_key.str());
    const TomlEntry entry{node, fmt::format("{}.{}", where, key)};
    bool is_set = false;
    for (const auto* const settings :
         {&run_setting_table(), &sequence_setting_table(), &subject_setting_table(), &clip_setting_table()}) {
      const Result<bool> set = set_from(*settings, key, entry, run);
      if (!set) return set.failure();
      is_set = is_set || *set;
    }
    if (!is_set) {
      const Result<bool> set = set_tracker(key, entry, run);
      if (!set) return set.failure();
      if (!*set) return error("{}: no such setting", entry.where);
      key = key_of_tracker(tracker_option_of(key)->name);
    }
    if (given != nullptr) given->insert_or_assign(key, entry.where);
  }
  return {};
}

}  // namespace silpose
