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
  return values_text(info);
}

}  // namespace

void add_table_option(CLI::App& app, const OptionInfo& info, const std::string& group, const std::string& defaults,
                      GivenOptions& given) {
  const std::string help = defaults.empty() ? info.help : fmt::format("{} ({})", info.help, defaults);
  if (info.kind == OptionKind::kFlag) {
    app.add_flag_function(
           fmt::format("--{0},!--no-{0}", info.name),
           [&given, name = info.name](int64_t count) { given.insert_or_assign(name, count > 0); }, help)
        ->group(group);
    return;
  }
  const CLI::Validator valid(
      [info](const std::string& text) -> std::string {
        const Result<OptionValue> value = parse_option(info, text);
        return value ? "" : value.error().message;
      },
      values_in_help(info));
  CLI::Option* const option = app.add_option_function<std::string>(
                                     "--" + info.name,
                                     [&given, info](const std::string& text) {
                                       given.insert_or_assign(info.name, parse_option(info, text).value());
                                     },
                                     help)
                                  ->type_name(type_name(info.kind))
                                  ->check(valid)
                                  ->group(group);
  // Every tracker takes this value: it is written with a result even where nothing has the option.
  if (info.off) option->default_str(text_of(*info.off));
}

}  // namespace silpose::app
