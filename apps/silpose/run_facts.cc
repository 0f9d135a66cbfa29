#include "apps/silpose/run_facts.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <fstream>
#include <thread>

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

nlohmann::ordered_json run_facts(const CommonOptions& common) {
  nlohmann::ordered_json facts;
  facts["version"] = SILPOSE_VERSION;
  facts["command"] = common.command_line;
  facts["seed"] = common.seed;
  facts["machine"] = machine_name();
  return facts;
}

Result<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
  return write_text_file(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace silpose::app
