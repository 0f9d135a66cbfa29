#include "silpose/experiment/run_result.h"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string unit_of(std::string_view score) {
  if (score.ends_with("_sd")) score.remove_suffix(3);
  constexpr std::array<std::pair<std::string_view, const char*>, 6> kUnits = {{{"_mm", "mm"},
                                                                               {"_px", "px"},
                                                                               {"_deg", "deg"},
                                                                               {"_npsu", "NPSU"},
                                                                               {"frames_per_second", "frames/s"},
                                                                               {"_s", "s"}}};
  for (const auto& [ending, unit] : kUnits) {
    if (score.ends_with(ending)) return unit;
  }
  return "1";
}

Result<void> write_run(const std::filesystem::path& file, std::string_view settings, const RunResult& run) {
  Json json;
  json["settings"] = settings;
  json["wall_s"] = run.wall_s;
  json["scores"] = run.scores;
  json["frame_columns"] = run.frame_columns;
  json["frames"] = run.frames;  // NaN is written as null
  return write_text_file(file, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::optional<RunResult> read_run(const std::filesystem::path& file, std::string_view settings) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return std::nullopt;
  try {
    const Json json = Json::parse(*text);
    if (json.at("settings").get<std::string>() != settings) return std::nullopt;
    RunResult run;
    run.wall_s = json.at("wall_s").get<double>();
    run.scores = json.at("scores").get<std::map<std::string, double>>();
    run.frame_columns = json.at("frame_columns").get<std::vector<std::string>>();
    for (const Json& row : json.at("frames")) {
      std::vector<double>& values = run.frames.emplace_back();
      for (const Json& value : row) {
        values.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
      }
      if (values.size() != run.frame_columns.size()) return std::nullopt;
    }
    return run;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace silpose
