#include "apps/silpose/command.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace silpose::app {
namespace {

template <class... Args>
[[noreturn]] void throw_usage(fmt::format_string<Args...> format, Args&&... args) {
  throw UsageError(fmt::format(format, std::forward<Args>(args)...));
}

bool parse_number(const std::string& text, double& number) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  return (stream >> number) && stream.peek() == std::char_traits<char>::eof() && std::isfinite(number);
}

}  // namespace

CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        double number = 0;
        if (parse_number(text, number) && number >= low && number <= high) return "";
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
      },
      fmt::format("{:g} to {:g}", low, high));
}

void add_common_options(CLI::App& command, CommonOptions& common) {
  command.add_option("--seed", common.seed, "Seed of all random numbers (same seed, same bytes)")
      ->capture_default_str()
      ->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            uint64_t seed = 0;
            const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), seed);
            return bad == std::errc() && end == text.data() + text.size() ? "" : text + " is not a whole number from 0";
          },
          ""));
  command.add_option("--threads", common.threads, "At most this many (0: all cores)")->check(CLI::Range(0, 1024));
  command.add_flag("--quiet", common.quiet, "No progress, no messages");
  command.add_flag("--json", common.json, "One JSON object on standard output");
}

Size parse_size(const std::string& option, const std::string& text) {
  Size size;
  const char* const end = text.data() + text.size();
  const auto [cross, bad_width] = std::from_chars(text.data(), end, size.width);
  const bool has_cross = bad_width == std::errc() && cross != end && *cross == 'x';
  if (!has_cross) throw_usage("{}: {} is not WIDTHxHEIGHT", option, text);
  const auto [rest, bad_height] = std::from_chars(cross + 1, end, size.height);
  if (bad_height != std::errc() || rest != end) throw_usage("{}: {} is not WIDTHxHEIGHT", option, text);
  if (size.width < 16 || size.width > 8192 || size.height < 16 || size.height > 8192) {
    throw_usage("{}: {} is outside 16x16 to 8192x8192", option, text);
  }
  return size;
}

std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    double number = 0;
    if (!parse_number(word, number)) throw_usage("{}: {} is not a number", option, word);
    numbers.push_back(number);
  }
  if (numbers.size() != count || text.back() == ',') {
    throw_usage("{}: {} numbers expected, separated by commas, got {}", option, count, text);
  }
  return numbers;
}

}  // namespace silpose::app
