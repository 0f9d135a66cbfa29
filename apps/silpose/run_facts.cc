#include "apps/silpose/run_facts.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <cmath>
#include <fstream>
#include <thread>
#include <utility>

#include "apps/silpose/option_file.h"
#include "silpose/base/text_file.h"

namespace silpose::app {

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

nlohmann::ordered_json figure(double mean, double std) {
  if (std::isnan(mean)) return nullptr;
  return {{"mean", mean}, {"std", std}};
}

nlohmann::ordered_json run_facts(const CommonOptions& common) {
  nlohmann::ordered_json facts;
  facts["version"] = SILPOSE_VERSION;
  facts["command"] = common.command_line;
  facts["seed"] = common.seed;
  facts["machine"] = machine_name();
  return facts;
}

Result<Outcome> deliver(ResultDirectory& directory, const CLI::App& command,
                        const std::map<std::string, std::string>& chosen, Outcome outcome, Console& console) {
  if (outcome.interrupted) {
    const std::string line = fmt::format("interrupted; {} holds what is done", directory.path().string());
    outcome.json["error"] = line;
    console.error(line);
  }
  const std::string text = outcome.json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
  for (const Result<void>& written : {write_option_file(directory.path() / "config.toml", command, chosen),
                                      write_text_file(directory.path() / "run.json", text + "\n")}) {
    if (!written) return written.failure();
  }
  if (outcome.interrupted) {
    directory.keep();
    return outcome;
  }
  const Result<void> done = directory.commit();
  if (!done) return done.failure();
  return outcome;
}

}  // namespace silpose::app
