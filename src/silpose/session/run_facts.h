// What is written down of a run in every result directory: run.json and config.toml.
// Threads: functions without state.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "silpose/base/option_file.h"
#include "silpose/base/result.h"
#include "silpose/offline/body_fit.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/result_directory.h"
#include "silpose/session/run_context.h"

namespace silpose {

// version, command, seed, machine: how every run.json begins.
nlohmann::ordered_json run_facts(const ProgramRun& run);

// "AMD EPYC 7B13, 2 threads, Linux 6.1.0": the processor and system that results were made on.
std::string machine_name();

// A mean and its standard deviation, {"mean", "std"}; null where the mean is NaN.
nlohmann::ordered_json figure(double mean, double std);

// {"mean", "std", "from"} in pixels: what was known of the focal length before the clip was analysed.
nlohmann::ordered_json facts_of(const FocalSource& source);

// {"focal_px": {mean, std}, "height_m": ..., "tilt_deg": ..., "roll_deg": ..., "frames": N, "body_height_m": H}
nlohmann::ordered_json facts_of(const CameraEstimate& estimate);

// {"lengths_m": {"right_shin_length": {mean, std}, ...}, "girths": {...}, "size": {...}}: what was fitted of these.
nlohmann::ordered_json facts_of(const BodyFit& fit);

// Ends the directory of a command: writes config.toml and run.json, and renames it to its final name or, where the work
// was interrupted, leaves it as DIR.partial. Errors: not writable, cannot be renamed.
Result<void> finish_result(ResultDirectory& directory, std::string_view command, const OptionLines& options,
                           const nlohmann::ordered_json& facts, bool interrupted);

}  // namespace silpose
