// RunResult: the result of one run: scores by name, and a row of numbers per frame. Kept as one small JSON file each,
// so that a stopped experiment resumes where it was.
// Threads: values and functions without state.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

struct RunResult {
  // "joint_error_mm" or "FAMILY/MEMBER"; one that there is no number for is left out.
  std::map<std::string, double> scores;
  std::vector<std::string> frame_columns;   // the first is "frame"
  std::vector<std::vector<double>> frames;  // [T][columns]; NaN: no value
  double wall_s = 0;                        // all of the run, not only the tracker
};

// The unit of a score by the ending of its name: "mm", "px", "deg", "NPSU", "frames/s", "s"; "1" for the rest.
std::string unit_of(std::string_view score);

// A run's file. `settings` identifies the run. Errors: not writable.
Result<void> write_run(const std::filesystem::path& file, std::string_view settings, const RunResult& run);

// Nothing where there is no such file, or it is of other settings, or broken: the run must then be done.
std::optional<RunResult> read_run(const std::filesystem::path& file, std::string_view settings);

}  // namespace silpose
