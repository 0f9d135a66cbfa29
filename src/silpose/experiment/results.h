// The files of an experiment: results.json, runs.csv, frames.csv, one CSV per table and one SVG per plot
// (docs/formats.md).
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "silpose/base/result.h"
#include "silpose/experiment/engine.h"
#include "silpose/experiment/grid.h"
#include "silpose/experiment/result_table.h"

namespace silpose {

// How the results were made, as results.json records it.
struct ResultFacts {
  std::string command, commit, machine;
  uint64_t seed = 1;
  int seeds = 1;
  bool quick = false;
};

// Writes into `folder`, which is there. Figures are those of every cell, "LABEL/LABEL/SCORE": mean and population
// standard deviation over its n seeds. Returns the main table.
// Errors: those of make_table(); files that cannot be written.
Result<ResultTable> write_results(const std::filesystem::path& folder, const Grid& grid,
                                  std::span<const FinishedRun> runs, const ResultFacts& facts);

}  // namespace silpose
