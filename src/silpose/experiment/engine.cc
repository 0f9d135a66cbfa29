#include "silpose/experiment/engine.h"

#include <cctype>
#include <set>
#include <system_error>

#include "silpose/base/check.h"

namespace silpose {

std::string run_key(const Grid& grid, size_t cell_idx, uint64_t seed) {
  std::string key;
  for (const std::string& label : grid.cells.at(cell_idx).labels) {
    for (const char c : label) {
      const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '+';
      key += plain ? c : '-';
    }
    key += '_';
  }
  return fmt::format("{}seed{}", key, seed);
}

Result<std::optional<std::vector<FinishedRun>>> run_grid(const Grid& grid, const EngineOptions& options,
                                                         const std::filesystem::path& folder, const Runner& runner,
                                                         ProgressSink* progress) {
  check(options.seeds > 0, "run_grid: {} seeds", options.seeds);
  std::set<std::string> keys;
  for (size_t cell = 0; cell < grid.cells.size(); ++cell) {
    if (!keys.insert(run_key(grid, cell, 0)).second) {
      return error("{}: two cells are both called {}", grid.name, run_key(grid, cell, 0));
    }
  }
  const std::filesystem::path runs_folder = folder / "runs";
  std::error_code failed;
  std::filesystem::create_directories(runs_folder, failed);
  if (failed) return error("{}: not writable ({})", runs_folder.string(), failed.message());

  const auto total = static_cast<int64_t>(grid.cells.size()) * options.seeds;
  std::vector<std::optional<FinishedRun>> runs(static_cast<size_t>(total));
  int64_t done = 0;
  const auto run_at = [&](size_t i) {
    const auto seeds = static_cast<size_t>(options.seeds);
    return std::pair<size_t, uint64_t>(i / seeds, options.first_seed + i % seeds);
  };
  const auto file_of = [&](size_t cell, uint64_t seed) { return runs_folder / (run_key(grid, cell, seed) + ".json"); };
  for (size_t i = 0; i < runs.size(); ++i) {  // first what is there, so that the estimate is of what is left
    const auto [cell, seed] = run_at(i);
    std::optional<RunResult> kept = read_run(file_of(cell, seed), settings_text(grid.cells[cell].settings));
    if (!kept) continue;
    runs[i] = FinishedRun{cell, seed, std::move(*kept)};
    ++done;
  }
  const std::string what = fmt::format("{}: runs", grid.name);
  const auto go_on = [&] { return progress == nullptr || progress->update(what, done, total); };
  for (size_t i = 0; i < runs.size(); ++i) {
    if (runs[i]) continue;
    if (!go_on()) return std::optional<std::vector<FinishedRun>>();
    const auto [cell, seed] = run_at(i);
    const RunSettings& settings = grid.cells[cell].settings;
    Result<std::optional<RunResult>> result = runner(settings, seed, go_on);
    if (!result) return error("{}: {}: {}", grid.name, run_key(grid, cell, seed), result.error().message);
    if (!*result) return std::optional<std::vector<FinishedRun>>();
    const Result<void> written = write_run(file_of(cell, seed), settings_text(settings), **result);
    if (!written) return written.failure();
    runs[i] = FinishedRun{cell, seed, std::move(**result)};
    ++done;
  }
  std::vector<FinishedRun> finished;
  finished.reserve(runs.size());
  for (std::optional<FinishedRun>& run : runs) finished.push_back(std::move(*run));
  return std::optional<std::vector<FinishedRun>>(std::move(finished));
}

}  // namespace silpose
