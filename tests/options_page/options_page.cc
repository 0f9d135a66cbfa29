// Writes docs/options.md from the option tables: `options_page FILE`. With --check FILE: exit 1 where the file differs.
#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/base/text_file.h"
#include "silpose/experiment/run_settings.h"
#include "silpose/segment/segmentation_options.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/input_options.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

constexpr const char* kCommand = "build/release/tests/options_page/options_page docs/options.md";

std::string row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += cell.empty() ? " |" : " " + cell + " |";
  return line + "\n";
}

std::string shown(const std::optional<OptionValue>& value) {
  if (!value) return "";
  const std::string text = text_of(*value);
  return text == "true" ? "on" : text == "false" ? "off" : text;
}

std::string values_shown(const OptionInfo& info) {
  return info.kind == OptionKind::kFlag ? "on, off" : values_text(info);
}

std::string option_shown(const OptionInfo& info) {
  if (info.kind == OptionKind::kFlag) return fmt::format("`--{0}`, `--no-{0}`", info.name);
  return fmt::format("`--{}`", info.name);
}

// The options of one struct, with the values that it has by itself.
template <class S>
std::string plain_section(const OptionTable<S>& table) {
  std::string text = fmt::format("### {}\n\n{}{}", table.group, row({"option", "values", "not given", "what it does"}),
                                 row({"---", "---", "---", "---"}));
  for (const Option<S>& option : table.options) {
    const std::string values =
        option.info.kind == OptionKind::kTexts ? "a text; may be repeated" : values_shown(option.info);
    text += row({option_shown(option.info), values, shown(option.get(S{})), option.info.help});
  }
  return text + "\n";
}

// The options of one struct, with their values in the presets that have it.
template <class S>
std::string tracker_section(const OptionTable<S>& table) {
  std::vector<std::string> head = {"option", "values"}, line = {"---", "---"};
  std::vector<GivenOptions> values;
  for (const Preset& preset : presets()) {
    GivenOptions named = named_options(preset.options());
    if (!named.contains(table.options.front().info.name)) continue;
    head.push_back(preset.name);
    line.emplace_back("---");
    values.push_back(std::move(named));
  }
  head.emplace_back("what it does");
  line.emplace_back("---");
  std::string text = fmt::format("### {}\n\n{}{}", table.group, row(head), row(line));
  for (const Option<S>& option : table.options) {
    const OptionInfo& info = option.info;
    std::vector<std::string> cells = {option_shown(info), values_shown(info)};
    for (const GivenOptions& named : values) cells.push_back(shown(named.at(info.name)));
    cells.push_back(info.help);
    text += row(cells);
  }
  return text + "\n";
}

std::string settings_section(const OptionTable<RunSettings>& table) {
  std::string text = fmt::format("### {}\n\n{}{}", table.group, row({"setting", "values", "not given", "what it is"}),
                                 row({"---", "---", "---", "---"}));
  for (const Option<RunSettings>& option : table.options) {
    text += row({fmt::format("`{}`", option.info.name), values_shown(option.info), shown(option.get(RunSettings{})),
                 option.info.help});
  }
  return text + "\n";
}

std::string page() {
  return fmt::format("# Options\n\nMade from the option tables in the source by `{}`.\n\n", kCommand) +
         "## The tracker\n\n"
         "As options of `silpose track`, and as keys of `--config` and `config.toml` without the dashes in front. The "
         "columns\nof presets tell the value where an option is not given. `--preset default` and `accurate` become "
         "one sampling filter\nwith `--particles` or `--layers`: with more than one layer the column \"with layers\" "
         "holds, else \"with particles\".\n\n" +
         tracker_section(tracker_option_table()) + tracker_section(fitted_option_table()) +
         tracker_section(sampling_option_table()) +
         "## The input\n\n"
         "Of commands that read videos: `track`, `segment` and `model fit`. Those of a calibration file also of "
         "`synth` "
         "and\n`render`, those of the focal length of `track` only. In a file lists are TOML lists.\n\n" +
         plain_section(segmentation_option_table()) + plain_section(input_option_table()) +
         plain_section(camera_option_table()) + plain_section(focal_option_table()) +
         "## Experiments\n\n"
         "Settings of a run in `experiments/NAME.toml` (docs/formats.md). Every option of the tracker is one, too, "
         "with\n"
         "underscores: `resample_below = 0.5`. It may have `tracker_` in front, and needs it where a setting below has "
         "its\nname: `tracker_motion` is the motion model.\n\n" +
         settings_section(run_setting_table()) + settings_section(sequence_setting_table()) +
         settings_section(subject_setting_table()) + settings_section(clip_setting_table());
}

int run(const std::vector<std::string>& arguments) {
  std::string text = page();
  text.pop_back();  // one line break at the end
  if (arguments.size() == 2 && arguments[0] == "--check") {
    const Result<std::string> committed = read_text_file(arguments[1]);
    if (committed && *committed == text) return 0;
    fmt::print(stderr, "{}: {}; regenerate with: {}\n", arguments[1],
               committed ? "differs from the option tables" : committed.error().message, kCommand);
    return 1;
  }
  if (arguments.size() != 1) {
    fmt::print(stderr, "usage: options_page [--check] FILE\n");
    return 2;
  }
  const Result<void> written = write_text_file(arguments[0], text);
  if (!written) fmt::print(stderr, "{}\n", written.error().message);
  return written ? 0 : 1;
}

}  // namespace
}  // namespace silpose

int main(int argc, char** argv) { return silpose::run({argv + 1, argv + argc}); }
