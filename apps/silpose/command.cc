#include "apps/silpose/command.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "silpose/base/data_folder.h"
#include "silpose/base/option_error.h"

namespace silpose::app {

RunContext context_of(Console& console) {
  return {.data = data_directory(), .progress = &console, .message = [&console](const std::string& line) {
            console.message(line);
          }};
}

CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        std::istringstream stream(text);
        stream.imbue(std::locale::classic());
        double number = 0;
        const bool is_number = (stream >> number) && stream.peek() == std::char_traits<char>::eof();
        if (is_number && std::isfinite(number) && number >= low && number <= high) return "";
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
      },
      fmt::format("{:g} to {:g}", low, high));
}

Size parse_size(const std::string& option, const std::string& text) {
  Size size;
  const char* const end = text.data() + text.size();
  const auto [cross, bad_width] = std::from_chars(text.data(), end, size.width);
  const bool has_cross = bad_width == std::errc() && cross != end && *cross == 'x';
  if (!has_cross) throw_option_error("{}: {} is not WIDTHxHEIGHT", option, text);
  const auto [rest, bad_height] = std::from_chars(cross + 1, end, size.height);
  if (bad_height != std::errc() || rest != end) throw_option_error("{}: {} is not WIDTHxHEIGHT", option, text);
  if (size.width < 16 || size.width > 8192 || size.height < 16 || size.height > 8192) {
    throw_option_error("{}: {} is outside 16x16 to 8192x8192", option, text);
  }
  return size;
}

}  // namespace silpose::app
