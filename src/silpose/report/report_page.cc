#include "silpose/report/report_page.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/report/page_template.h"

namespace silpose {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Which heading a DOF is shown under.
std::string part_of(const std::string& dof) {
  if (dof.starts_with("root")) return "Root";
  const bool right = dof.starts_with("right_"), left = dof.starts_with("left_");
  if (!right && !left) return "Trunk and head";
  const bool leg = dof.find("thigh") != std::string::npos || dof.find("shin") != std::string::npos ||
                   dof.find("foot") != std::string::npos;
  return std::string(right ? "Right " : "Left ") + (leg ? "leg" : "arm");
}

// Three decimals are more than a curve shows; NaN has no place in JSON.
Json rounded(double value) { return std::isfinite(value) ? Json(std::round(value * 1000) / 1000) : Json(nullptr); }

Json data_of(const ReportInput& input) {
  const std::vector<RecordedStep>& steps = input.recording->steps;
  Json data;
  data["fps"] = input.fps;
  data["facts"] = input.facts;
  data["warnings"] = input.warnings;
  data["stages"] = Json::array();
  for (const auto& [stage, seconds] : input.stages_s) data["stages"].push_back({stage, rounded(seconds)});

  for (const char* name : {"frame", "time", "state", "accuracy", "n_eff"}) data[name] = Json::array();
  for (const RecordedStep& step : steps) {
    const bool compared = step.state != StepReport::State::kWaiting && step.state != StepReport::State::kCoasted;
    data["frame"].push_back(step.frame_idx);
    data["time"].push_back(rounded(static_cast<double>(step.time_ns) * 1e-9));
    data["state"].push_back(state_name(step.state));
    data["accuracy"].push_back(compared ? rounded(step.visual_accuracy) : Json(nullptr));
    data["n_eff"].push_back(compared ? rounded(step.effective_sample_size) : Json(nullptr));
  }
  data["dofs"] = Json::array();
  for (size_t d = 0; d < input.skeleton->dofs().size(); ++d) {
    const Dof& dof = input.skeleton->dofs()[d];
    const double scale = dof.is_translation ? 1 : to_degrees(1);
    Json values = Json::array(), spread = Json::array();
    for (const RecordedStep& step : steps) {
      values.push_back(step.pose.empty() ? Json(nullptr) : rounded(step.pose[d] * scale));
      spread.push_back(step.spread.empty() ? Json(nullptr) : rounded(step.spread[d] * scale));
    }
    data["dofs"].push_back({{"name", dof.name},
                            {"part", part_of(dof.name)},
                            {"unit", dof.is_translation ? "m" : "°"},
                            {"limits", dof.is_periodic || dof.is_translation
                                           ? Json(nullptr)
                                           : Json{rounded(dof.lower * scale), rounded(dof.upper * scale)}},
                            {"values", std::move(values)},
                            {"sd", std::move(spread)}});
  }
  return data;
}

void replace(std::string& text, std::string_view what, std::string_view by) {
  const size_t at = text.find(what);
  if (at != std::string::npos) text.replace(at, what.size(), by);
}

}  // namespace

Result<std::string> make_report(const ReportInput& input) {
  check(input.recording != nullptr && input.skeleton != nullptr, "make_report: recording and skeleton are wanted");
  std::string video;
  if (!input.overlay_video.empty()) {
    std::error_code failed;
    const uintmax_t size = std::filesystem::file_size(input.overlay_video, failed);
    if (failed) return error("{}: {}", input.overlay_video.string(), failed.message());
    if (size <= static_cast<uintmax_t>(input.embed_limit_bytes)) {
      const Result<std::string> bytes = read_text_file(input.overlay_video);
      if (!bytes) return bytes.failure();
      video = "data:video/mp4;base64," + base64(*bytes);
    } else {
      video = escape_html(input.overlay_video.filename().string());
    }
  }
  // Inside a script element no "<" may stand that HTML could take for markup.
  std::string json;
  for (const char c : data_of(input).dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      json += "\\u003c";
    } else {
      json += c;
    }
  }

  std::string page(kPageTemplate);
  replace(page, "@TITLE@", escape_html(input.title));
  replace(page, "@TITLE@", escape_html(input.title));
  replace(page, "@DATA@", json);
  replace(page, "@VIDEO@", video);
  return page;
}

Result<void> write_report(const std::filesystem::path& path, const ReportInput& input) {
  const Result<std::string> page = make_report(input);
  if (!page) return page.failure();
  return write_text_file(path, *page);
}

}  // namespace silpose
