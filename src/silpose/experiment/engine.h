// Runs every cell of a grid for every seed, one after the other (a run itself uses all cores), and keeps each finished
// run as a file, so that a stopped experiment resumes where it was.
// Threads: one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/experiment/grid.h"
#include "silpose/experiment/run_result.h"

namespace silpose {

// Does one run; nothing when `go_on`, which it asks now and then, said false.
using Runner = std::function<Result<std::optional<RunResult>>(const RunSettings& settings, uint64_t seed,
                                                              const std::function<bool()>& go_on)>;

struct FinishedRun {
  size_t cell_idx = 0;
  uint64_t seed = 0;
  RunResult result;
};

struct EngineOptions {
  uint64_t first_seed = 1;
  int seeds = 5;  // first_seed, first_seed + 1, ...
};

// Runs in order of cells, seeds fastest. Those that `folder`/runs/KEY.json has already, with the same settings, are
// taken from there. Nothing when `progress` asked to stop: what is done is in the files.
// Errors: a run's; a file that cannot be written; two cells whose labels make the same file name.
Result<std::optional<std::vector<FinishedRun>>> run_grid(const Grid& grid, const EngineOptions& options,
                                                         const std::filesystem::path& folder, const Runner& runner,
                                                         ProgressSink* progress = nullptr);

// The name of a run's file without folder and extension: "walk_side_default_seed1".
std::string run_key(const Grid& grid, size_t cell_idx, uint64_t seed);

}  // namespace silpose
