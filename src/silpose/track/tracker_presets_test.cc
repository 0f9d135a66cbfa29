#include "silpose/track/tracker_presets.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

// Every named option of a tracker, as text.
using Texts = std::map<std::string, std::string>;
Texts texts_of(const TrackerOptions& options) {
  Texts texts;
  for (const auto& [name, value] : named_options(options)) texts[name] = text_of(value);
  return texts;
}

Texts with(Texts texts, const Texts& changes) {
  for (const auto& [name, text] : changes) texts[name] = text;
  return texts;
}

const Texts kDefault = {
    {"vertices", "2500"}, {"evidence", "both"}, {"hypotheses", "4"}, {"smooth", "false"}, {"floor", "true"}};
const Texts kPlain = {{"vertices", "2000"},    {"evidence", "both"},          {"particles", "1000"},
                      {"layers", "1"},         {"motion", "diffusion"},       {"sigma-deg", "4"},
                      {"resample-below", "1"}, {"resampling", "systematic"},  {"regenerate", "0"},
                      {"sharpness", "100"},    {"regenerate-from", "random"}, {"metric", "pixel-count"},
                      {"root", "tracked"},     {"estimate", "mean"}};

Texts made(std::string_view preset, const Texts& texts) {
  GivenOptions given;
  for (const auto& [name, text] : texts) {
    for (const OptionInfo* const info :
         {tracker_option_table().find(name) != nullptr ? &tracker_option_table().find(name)->info : nullptr,
          fitted_option_table().find(name) != nullptr ? &fitted_option_table().find(name)->info : nullptr,
          sampling_option_table().find(name) != nullptr ? &sampling_option_table().find(name)->info : nullptr}) {
      if (info != nullptr) given[name] = parse_option(*info, text).value();
    }
  }
  return texts_of(make_tracker_options(preset, given));
}

// The full set of values that tracks are made with: a change here changes every track.
TEST(Presets, HaveTheseValues) {
  EXPECT_EQ(texts_of(default_preset()), kDefault);
  EXPECT_EQ(texts_of(accurate_preset()), with(kDefault, {{"vertices", "0"}, {"hypotheses", "8"}, {"smooth", "true"}}));
  EXPECT_EQ(texts_of(plain_preset()), kPlain);
  EXPECT_EQ(texts_of(annealed_preset()), with(kPlain, {{"particles", "500"}, {"layers", "10"}, {"sigma-deg", "2"}}));
  EXPECT_EQ(texts_of(thesis_preset()), with(kPlain, {{"resampling", "comb"}, {"regenerate", "0.2"}}));
  EXPECT_TRUE(thesis_preset().sampling()->separate_root);
  EXPECT_FALSE(plain_preset().sampling()->separate_root);
  EXPECT_FALSE(annealed_preset().sampling()->separate_root);
  EXPECT_EQ(texts_of(TrackerOptions{}), kDefault);
  for (const Preset& preset : presets()) {
    const TrackerOptions options = preset.options();
    EXPECT_EQ(options.size_deviation, 0) << preset.name;
    EXPECT_EQ(options.seed, 1u) << preset.name;
    EXPECT_FALSE(options.landmarks) << preset.name;
    EXPECT_EQ(options.initial_pose, std::nullopt) << preset.name;
    EXPECT_EQ(options.proposal, nullptr) << preset.name;
  }
}

TEST(Presets, BecomeSamplingFiltersWithParticlesOrLayers) {
  EXPECT_EQ(made("default", {}), kDefault);
  for (const char* preset : {"default", "accurate"}) {
    EXPECT_EQ(made(preset, {{"particles", "50"}}), with(kPlain, {{"particles", "50"}})) << preset;
    EXPECT_EQ(made(preset, {{"layers", "1"}}), kPlain) << preset;
    EXPECT_EQ(made(preset, {{"layers", "4"}}),
              with(kPlain, {{"particles", "500"}, {"layers", "4"}, {"sigma-deg", "2"}}))
        << preset;
    EXPECT_EQ(
        made(preset, {{"particles", "50"}, {"layers", "4"}, {"metric", "coverage"}, {"root", "fixed"}}),
        with(kPlain,
             {{"particles", "50"}, {"layers", "4"}, {"sigma-deg", "2"}, {"metric", "coverage"}, {"root", "fixed"}}))
        << preset;
  }
  EXPECT_EQ(made("thesis", {{"particles", "50"}, {"layers", "1"}}),
            with(kPlain, {{"particles", "50"}, {"resampling", "comb"}, {"regenerate", "0.2"}}));
  EXPECT_EQ(made("accurate", {{"smooth", "false"}, {"vertices", "800"}}),
            with(kDefault, {{"hypotheses", "8"}, {"vertices", "800"}}));
}

// What config.toml holds leads to the same options.
TEST(Presets, NamedOptionsLeadToTheSameOptions) {
  for (const Preset& preset : presets()) {
    const TrackerOptions options = preset.options();
    const std::string name = preset.by_option.empty() ? preset.name : "accurate";
    const TrackerOptions again = make_tracker_options(name, named_options(options));
    EXPECT_EQ(again.filter, options.filter) << preset.name;
    EXPECT_EQ(texts_of(again), texts_of(options)) << preset.name;
  }
}

// An option of one filter is not silently ignored by the other.
TEST(RefusedOption, SaysWhyTheFilterDoesNotHaveIt) {
  const auto refusal = [](std::string_view preset, const GivenOptions& given, std::string_view prefix = "") {
    const std::optional<RefusedOption> refused = refused_option(preset, given, prefix);
    return refused ? fmt::format("{}{}: {}", prefix, refused->name, refused->why) : "";
  };
  const OptionValue two = int64_t{2}, on = true, off = false;
  EXPECT_EQ(refusal("default", {{"particles", two}, {"hypotheses", two}}, "--"),
            "--hypotheses: not together with --particles");
  EXPECT_EQ(refusal("accurate", {{"layers", two}, {"smooth", on}}, "--"), "--smooth: not together with --layers");
  EXPECT_EQ(refusal("thesis", {{"floor", on}}, "--"), "--floor: not together with --preset thesis");
  EXPECT_EQ(refusal("thesis", {{"floor", on}}), "floor: not together with preset thesis");
  EXPECT_EQ(refusal("default", {{"metric", std::string("pixel-count")}}),
            "metric: needs particles, layers or preset thesis");
  EXPECT_EQ(refusal("default", {{"root", std::string("fixed")}}, "--"),
            "--root fixed: needs --particles, --layers or --preset thesis");
  for (const Option<SamplingOptions>& option : sampling_option_table().options) {
    const std::string& name = option.info.name;
    if (name == "particles" || name == "layers" || name == "root") continue;
    const GivenOptions given = {{name, *option.get(SamplingOptions{})}};
    EXPECT_EQ(refusal("accurate", given), name + ": needs particles, layers or preset thesis");
    EXPECT_EQ(refusal("thesis", given), "");
  }
  EXPECT_EQ(refusal("thesis", {{"smooth", off}, {"floor", off}}), "") << "they ask for nothing";
  EXPECT_EQ(refusal("default", {{"root", std::string("tracked")}}), "");
}

TEST(MakeTrackerOptions, ThrowsWhatItDoesNotKnow) {
  const auto thrown = [](std::string_view preset, const GivenOptions& given) -> std::string {
    try {
      (void)make_tracker_options(preset, given);
    } catch (const std::invalid_argument& wrong) {
      return wrong.what();
    }
    return "";
  };
  EXPECT_EQ(thrown("best", {}), "preset: 'best' is not one of default, accurate, thesis");
  EXPECT_EQ(thrown("default", {{"speed", 1.0}}), "speed: not an option of the tracker");
  EXPECT_EQ(thrown("thesis", {{"hypotheses", int64_t{2}}}), "hypotheses: not together with preset thesis");
}

TEST(DefaultsText, NamesThePresetsThatDiffer) {
  EXPECT_EQ(defaults_text("hypotheses"), "4; accurate: 8");
  EXPECT_EQ(defaults_text("smooth"), "off; accurate: on");
  EXPECT_EQ(defaults_text("sharpness"), "100");
  EXPECT_EQ(defaults_text("particles"), "500; thesis: 1000");
  EXPECT_EQ(defaults_text("layers"), "1");
}

}  // namespace
}  // namespace silpose
