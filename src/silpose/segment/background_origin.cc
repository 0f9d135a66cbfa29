#include "silpose/segment/background_origin.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>

namespace silpose {
namespace {

constexpr std::string_view kLeadIn = "lead-in:";

}  // namespace

Result<BackgroundOrigin> background_origin_of(const std::string& text) {
  if (text == "auto") return BackgroundOrigin(BackgroundOfClip{});
  if (text == "online") return BackgroundOrigin(BackgroundOnline{});
  if (text == "online:knn") return BackgroundOrigin(BackgroundOnline{.knn = true});
  if (!text.starts_with(kLeadIn)) return BackgroundOrigin(BackgroundPlate{text});
  const char* end = text.data() + text.size();
  double seconds = 0;
  const auto [stop, failure] = std::from_chars(text.data() + kLeadIn.size(), end, seconds);
  if (failure != std::errc() || stop != end || !(seconds > 0) || seconds > kLongestLeadIn_s) {
    return error("background '{}': lead-in wants a positive number of seconds", text);
  }
  return BackgroundOrigin(BackgroundLeadIn{seconds});
}

std::string text_of(const BackgroundOrigin& origin) {
  if (const auto* online = std::get_if<BackgroundOnline>(&origin)) return online->knn ? "online:knn" : "online";
  if (const auto* lead_in = std::get_if<BackgroundLeadIn>(&origin)) return fmt::format("lead-in:{}", lead_in->seconds);
  if (const auto* plate = std::get_if<BackgroundPlate>(&origin)) return plate->path;
  return "auto";
}

}  // namespace silpose
