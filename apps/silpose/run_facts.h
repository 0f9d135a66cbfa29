// run.json: what was run and what came of it, in every result directory.
// Threads: the main thread only.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/silpose/command.h"
#include "silpose/base/result.h"

namespace silpose::app {

// version, command, seed, machine: how every run.json begins.
nlohmann::ordered_json run_facts(const CommonOptions& common);

// "AMD EPYC 7B13, 2 threads, Linux 6.1.0": the processor and system that results were made on.
std::string machine_name();

Result<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json);

}  // namespace silpose::app
