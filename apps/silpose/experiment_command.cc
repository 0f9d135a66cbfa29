// silpose experiment: runs experiments that experiments/NAME.toml describe, and writes their figures, tables and plots.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/data_folder.h"
#include "apps/silpose/run_facts.h"
#include "silpose/experiment/engine.h"
#include "silpose/experiment/experiment_directory.h"
#include "silpose/experiment/recorded_clip.h"
#include "silpose/experiment/results.h"
#include "silpose/experiment/tracking_runs.h"
#include "silpose_commit.h"

namespace silpose::app {
namespace {

namespace fs = std::filesystem;

struct ExperimentOptions {
  std::vector<std::string> names;
  std::string out, data;
  std::optional<int> seeds;
  bool list = false, quick = false, resume = false;
};

std::vector<fs::path> all_descriptions() {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiments_directory(), failed)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// NAME, or a path to a user's description.
Result<fs::path> find_description(const std::string& name) {
  if (fs::path(name).extension() == ".toml") return fs::path(name);
  std::vector<std::string> known;
  for (const fs::path& file : all_descriptions()) {
    known.push_back(file.stem().string());
    if (known.back() == name) return file;
  }
  return error("{}: no such experiment ({}, all, or a .toml file)", name, fmt::join(known, ", "));
}

Result<Outcome> list_experiments(const ExperimentOptions& options) {
  Outcome outcome;
  outcome.is_answer = true;
  outcome.json["experiments"] = nlohmann::ordered_json::array();
  for (const fs::path& file : all_descriptions()) {
    const Result<Grid> grid = read_grid(file, options.quick);
    if (!grid) return grid.failure();
    const size_t runs = grid->cells.size() * static_cast<size_t>(options.seeds.value_or(grid->seeds));
    outcome.json["experiments"].push_back({{"name", grid->name}, {"title", grid->title}, {"runs", runs}});
    outcome.text +=
        fmt::format("{}{:18} {:5} runs  {}", outcome.text.empty() ? "" : "\n", grid->name, runs, grid->title);
  }
  if (outcome.text.empty()) return error("{}: no experiments", experiments_directory().string());
  return outcome;
}

// Motion-capture files and recorded clips that a grid needs: missing ones are reported before hours of work, not after.
Result<void> check_data_files(const Grid& grid, const fs::path& data) {
  for (const GridCell& cell : grid.cells) {
    if (cell.settings.is_recorded()) {
      if (data.empty()) {
        return error("{}: needs recorded clips ({} and others): give their folder with --data", grid.name,
                     cell.settings.clip[0]);
      }
      if (Result<void> found = check_clip_files(cell.settings, data); !found) return found;
      continue;
    }
    const std::string& motion = cell.settings.motion;
    if (!is_motion_file(motion)) continue;
    if (data.empty()) {
      return error("{}: needs motion-capture files ({} and others): give their folder with --data", grid.name, motion);
    }
    std::error_code failed;
    if (!fs::is_regular_file(data / motion, failed)) return error("{}: no such file", (data / motion).string());
  }
  return {};
}

Result<std::vector<Grid>> read_grids(const ExperimentOptions& options) {
  std::vector<fs::path> files;
  for (const std::string& name : options.names) {
    if (name == "all") {
      const std::vector<fs::path> all = all_descriptions();
      files.insert(files.end(), all.begin(), all.end());
      continue;
    }
    const Result<fs::path> file = find_description(name);
    if (!file) return file.failure();
    files.push_back(*file);
  }
  std::vector<Grid> grids;
  for (const fs::path& file : files) {
    Result<Grid> grid = read_grid(file, options.quick);
    if (!grid) return grid.failure();
    if (options.seeds) grid->seeds = *options.seeds;
    for (const Grid& other : grids) {
      if (other.name == grid->name) throw UsageError(fmt::format("{}: given twice", grid->name));
    }
    const Result<void> found = check_data_files(*grid, options.data);
    if (!found) return found.failure();
    grids.push_back(std::move(*grid));
  }
  return grids;
}

Result<Outcome> run_experiments(const ExperimentOptions& options, const CommonOptions& common, Console& console) {
  if (options.list) return list_experiments(options);
  if (options.names.empty()) throw UsageError("NAME is missing; --list shows the experiments");
  if (options.out.empty()) throw UsageError("--out is missing");
  const Result<std::vector<Grid>> grids = read_grids(options);
  if (!grids) return grids.failure();
  Result<ExperimentDirectory> directory = ExperimentDirectory::create(options.out, options.resume);
  if (!directory) return directory.failure();

  Outcome outcome;
  outcome.is_answer = true;
  outcome.json = run_facts(common);
  outcome.json["out"] = options.out;
  outcome.json["experiments"] = nlohmann::ordered_json::object();
  TrackingRuns tracking([&](const std::string& model) { return choose_body(model, console); }, options.data,
                        data_directory() / "networks");
  const Runner runner = [&](const RunSettings& settings, uint64_t seed, const std::function<bool()>& go_on) {
    return tracking.run(settings, seed, go_on);
  };
  std::vector<std::string> names;
  for (const Grid& grid : *grids) {
    const auto runs =
        run_grid(grid, {.first_seed = common.seed, .seeds = grid.seeds}, directory->path(grid.name), runner, &console);
    if (!runs) return error("{} (finished runs are in {}.partial, for --resume)", runs.error().message, options.out);
    if (!*runs) {
      outcome.interrupted = true;
      outcome.is_answer = false;
      outcome.text = fmt::format("interrupted; finished runs are in {}.partial, for --resume", options.out);
      return outcome;
    }
    const Result<ResultTable> table = write_results(directory->path(grid.name), grid, **runs,
                                                    {.command = common.command_line,
                                                     .commit = SILPOSE_COMMIT,
                                                     .machine = machine_name(),
                                                     .seed = common.seed,
                                                     .seeds = grid.seeds,
                                                     .quick = options.quick});
    if (!table) return table.failure();
    names.push_back(grid.name);
    outcome.json["experiments"][grid.name] = {{"runs", (*runs)->size()}, {"results", grid.name + "/results.json"}};
    outcome.text += (outcome.text.empty() ? "" : "\n\n") + text_from_table(*table);
  }
  const Result<void> done = directory->commit(names);
  if (!done) return done.failure();
  return outcome;
}

}  // namespace

Command add_experiment(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<ExperimentOptions>();
  CLI::App* const app = program.add_subcommand("experiment", "Run experiments and write their figures");
  app->add_option("NAME", options->names, "Experiments named by --list, or all, or .toml files that describe one");
  app->add_option("--out", options->out, "Directory for the results, one folder per experiment");
  app->add_flag("--list", options->list, "List the available experiments");
  app->add_flag("--quick", options->quick, "A small part of each, to check that it works");
  app->add_option("--seeds", options->seeds, "How many seeds, counted from --seed; default: as the experiment says")
      ->check(CLI::Range(1, 10'000));
  app->add_flag("--resume", options->resume, "Resume from the runs in DIR.partial");
  app->add_option("--data", options->data,
                  "Folder of motion-capture files or recorded clips, for experiments that need them");
  return {app, [options, &common](Console& console) { return run_experiments(*options, common, console); }};
}

}  // namespace silpose::app
