#include "silpose/session/run_facts.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "silpose/base/text_file.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

nlohmann::ordered_json figure_of(const Estimated& value, double unit = 1) {
  return figure(unit * value.mean, unit * value.deviation);
}

}  // namespace

std::string machine_name() {
  std::string processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      processor = line.substr(colon + 2);
      break;
    }
  }
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} threads, {} {}", processor, std::thread::hardware_concurrency(), system.sysname,
                     system.release);
}

nlohmann::ordered_json run_facts(const ProgramRun& run) {
  return {{"version", run.version}, {"command", run.command_line}, {"seed", run.seed}, {"machine", machine_name()}};
}

nlohmann::ordered_json figure(double mean, double std) {
  if (std::isnan(mean)) return nullptr;
  return {{"mean", mean}, {"std", std}};
}

nlohmann::ordered_json facts_of(const FocalSource& source) {
  const Estimated focal = focal_px(source.prior);
  return {{"mean", focal.mean}, {"std", focal.deviation}, {"from", source.from}};
}

nlohmann::ordered_json facts_of(const CameraEstimate& estimate) {
  return {{"focal_px", figure_of(estimate.focal_px)},
          {"height_m", figure_of(estimate.height_m)},
          {"tilt_deg", figure_of(estimate.tilt, to_degrees(1))},
          {"roll_deg", figure_of(estimate.roll, to_degrees(1))},
          {"frames", estimate.num_frames},
          {"body_height_m", estimate.body_height_m}};
}

nlohmann::ordered_json facts_of(const BodyFit& fit) {
  nlohmann::ordered_json facts;
  if (fit.size) facts["size"] = figure(fit.size->factor, fit.size->deviation);
  for (size_t s = 0; s < fit.names.size(); ++s) {
    facts["lengths_m"][fit.names[s]] = figure(fit.lengths[s], fit.deviations[s]);
  }
  for (const BodyFit::Girth& girth : fit.girths) facts["girths"][girth.name] = figure(girth.share, girth.deviation);
  return facts;
}

Result<void> finish_result(ResultDirectory& directory, std::string_view command, const OptionLines& options,
                           const nlohmann::ordered_json& facts, bool interrupted) {
  const std::string text = facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  Result<void> written = write_option_file(directory.path() / "config.toml", command, options);
  if (written) written = write_text_file(directory.path() / "run.json", text);
  if (!written) return written;
  if (!interrupted) return directory.commit();
  directory.keep();
  return {};
}

}  // namespace silpose
