#include "silpose/track/tracker_presets.h"

#include <algorithm>

#include "silpose/base/check.h"

namespace silpose {
namespace {

const Preset& preset_of(std::string_view name) {
  const std::vector<std::string_view> names = preset_names();
  check(std::ranges::count(names, name) > 0, "preset: '{}' is not one of {}", name, fmt::join(names, ", "));
  return *std::ranges::find(presets(), name, &Preset::name);
}

// The preset, or the sampling filter that replaces it.
TrackerOptions base_of(std::string_view preset, const GivenOptions& given) {
  TrackerOptions named = preset_of(preset).options();
  if (named.sampling() != nullptr) return named;
  const auto layers = given.find("layers");
  if (layers != given.end() && layers->second != OptionValue(int64_t{1})) return annealed_preset();
  return layers != given.end() || given.contains("particles") ? plain_preset() : named;
}

// The first option of the table that is given and asks for something.
template <class S>
std::optional<std::string> first_given(const OptionTable<S>& table, const GivenOptions& given) {
  for (const Option<S>& option : table.options) {
    const auto value = given.find(option.info.name);
    if (value == given.end() || option.info.off == value->second) continue;
    const bool has_words = option.info.off && option.info.kind == OptionKind::kWord;
    return has_words ? fmt::format("{} {}", option.info.name, text_of(value->second)) : option.info.name;
  }
  return std::nullopt;
}

bool is_option(std::string_view name) {
  return tracker_option_table().find(name) != nullptr || fitted_option_table().find(name) != nullptr ||
         sampling_option_table().find(name) != nullptr;
}

}  // namespace

TrackerOptions default_preset() { return {.filter = FittedOptions{}, .lod_vertices = kTrackingLevel}; }

TrackerOptions accurate_preset() {
  return {.filter = FittedOptions{.num_hypotheses = 8, .smooth = true, .floor = true}, .lod_vertices = 0};
}

TrackerOptions thesis_preset() {
  return {.filter = SamplingOptions{.separate_root = true, .resampling = "comb", .regenerate = 0.2},
          .lod_vertices = kSamplingLevel};
}

TrackerOptions plain_preset() { return {.filter = SamplingOptions{}, .lod_vertices = kSamplingLevel}; }

// Layers add noise again and again: what a plain filter needs once would blur them.
TrackerOptions annealed_preset() {
  return {.filter = SamplingOptions{.num_particles = 500, .num_layers = 10, .sigma_deg = 2},
          .lod_vertices = kSamplingLevel};
}

const std::vector<Preset>& presets() {
  static const std::vector<Preset> kPresets = {{"default", default_preset},
                                               {"accurate", accurate_preset},
                                               {"with particles", plain_preset, "particles"},
                                               {"with layers", annealed_preset, "layers"},
                                               {"thesis", thesis_preset}};
  return kPresets;
}

std::vector<std::string_view> preset_names() {
  std::vector<std::string_view> names;
  for (const Preset& preset : presets()) {
    if (preset.by_option.empty()) names.push_back(preset.name);
  }
  return names;
}

TrackerOptions make_tracker_options(std::string_view preset, const GivenOptions& given) {
  TrackerOptions options = base_of(preset, given);
  for (const auto& [name, value] : given) check(is_option(name), "{}: not an option of the tracker", name);
  const std::optional<RefusedOption> refused = refused_option(preset, given);
  check(!refused, "{}: {}", refused ? refused->name : "", refused ? refused->why : "");
  tracker_option_table().apply(given, options);
  if (FittedOptions* const fitted = options.fitted()) fitted_option_table().apply(given, *fitted);
  if (SamplingOptions* const sampling = options.sampling()) sampling_option_table().apply(given, *sampling);
  return options;
}

std::optional<RefusedOption> refused_option(std::string_view preset, const GivenOptions& given,
                                            std::string_view prefix) {
  if (base_of(preset, given).sampling() == nullptr) {
    const std::optional<std::string> name = first_given(sampling_option_table(), given);
    if (!name) return std::nullopt;
    return RefusedOption{*name, fmt::format("needs {0}particles, {0}layers or {0}preset thesis", prefix)};
  }
  const std::optional<std::string> name = first_given(fitted_option_table(), given);
  if (!name) return std::nullopt;
  const std::string sampler = given.contains("particles") ? "particles"
                              : given.contains("layers")  ? "layers"
                                                          : fmt::format("preset {}", preset);
  return RefusedOption{*name, fmt::format("not together with {}{}", prefix, sampler)};
}

GivenOptions named_options(const TrackerOptions& options) {
  GivenOptions named;
  tracker_option_table().collect(options, named);
  if (options.fitted() != nullptr) fitted_option_table().collect(*options.fitted(), named);
  if (options.sampling() != nullptr) sampling_option_table().collect(*options.sampling(), named);
  return named;
}

std::string defaults_text(std::string_view option) {
  // Values in order, each with the presets that have it.
  std::vector<std::pair<std::string, std::vector<std::string>>> values;
  for (const Preset& preset : presets()) {
    const GivenOptions named = named_options(preset.options());
    const auto value = named.find(option);
    if (value == named.end() || preset.by_option == option) continue;
    std::string text = text_of(value->second);
    if (text == "true" || text == "false") text = text == "true" ? "on" : "off";
    const auto same = std::ranges::find(values, text, &decltype(values)::value_type::first);
    if (same != values.end()) {
      same->second.push_back(preset.name);
    } else {
      values.push_back({text, {preset.name}});
    }
  }
  std::string text;
  for (const auto& [value, names] : values) {
    text += text.empty() ? value : fmt::format("; {}: {}", fmt::join(names, ", "), value);
  }
  return text;
}

}  // namespace silpose
