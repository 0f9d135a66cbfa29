#include "apps/silpose/table_options.h"

#include <fmt/format.h>

namespace silpose::app {
namespace {

const char* type_name(OptionKind kind) {
  switch (kind) {
    case OptionKind::kWhole:
      return "INT";
    case OptionKind::kNumber:
      return "FLOAT";
    case OptionKind::kFlag:
    case OptionKind::kWord:
    case OptionKind::kText:
    case OptionKind::kTexts:
    case OptionKind::kPair:
      break;
  }
  return "TEXT";
}

std::string values_in_help(const OptionInfo& info) {
  if (info.kind == OptionKind::kWord) return fmt::format("{{{}}}", fmt::join(info.words, ","));
  if (info.kind == OptionKind::kText) return "";
  return values_text(info);
}

}  // namespace

CLI::Option* add_table_option(CLI::App& app, const OptionInfo& info, const std::string& help,
                              const std::function<void(const OptionValue&)>& take) {
  if (info.kind == OptionKind::kFlag) {
    return app.add_flag_function(
        fmt::format("--{0},!--no-{0}", info.name), [take](int64_t count) { take(count > 0); }, help);
  }
  if (info.kind == OptionKind::kTexts) {  // one per use of the option: texts may have commas in them
    return app.add_option_function<std::vector<std::string>>("--" + info.name, take, help)->allow_extra_args(false);
  }
  const CLI::Validator valid(
      [info](const std::string& text) -> std::string {
        const Result<OptionValue> value = parse_option(info, text);
        return value ? "" : value.error().message;
      },
      values_in_help(info));
  return app
      .add_option_function<std::string>(
          "--" + info.name, [take, info](const std::string& text) { take(parse_option(info, text).value()); }, help)
      ->type_name(type_name(info.kind))
      ->check(valid);
}

}  // namespace silpose::app
