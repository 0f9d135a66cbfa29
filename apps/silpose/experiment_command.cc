// silpose experiment: runs experiments that experiments/NAME.toml describe, and writes their figures, tables and plots.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/command.h"
#include "silpose/base/data_folder.h"
#include "silpose/base/option_error.h"
#include "silpose/experiment/descriptions.h"
#include "silpose/experiment/engine.h"
#include "silpose/experiment/experiment_directory.h"
#include "silpose/experiment/results.h"
#include "silpose/experiment/tracking_runs.h"
#include "silpose/session/body_choice.h"
#include "silpose/session/run_facts.h"
#include "silpose_commit.h"

namespace silpose::app {
namespace {

struct ExperimentOptions {
  GridChoice grids;
  std::string out, data;
  bool list = false, resume = false;
};

Result<Outcome> list_experiments(const ExperimentOptions& options) {
  Outcome outcome;
  outcome.is_answer = true;
  outcome.json["experiments"] = nlohmann::ordered_json::array();
  for (const std::filesystem::path& file : all_descriptions(experiments_directory())) {
    const Result<Grid> grid = read_grid(file, options.grids.quick);
    if (!grid) return grid.failure();
    const size_t runs = grid->cells.size() * static_cast<size_t>(options.grids.seeds.value_or(grid->seeds));
    outcome.json["experiments"].push_back({{"name", grid->name}, {"title", grid->title}, {"runs", runs}});
    outcome.text +=
        fmt::format("{}{:18} {:5} runs  {}", outcome.text.empty() ? "" : "\n", grid->name, runs, grid->title);
  }
  if (outcome.text.empty()) return error("{}: no experiments", experiments_directory().string());
  return outcome;
}

Result<Outcome> run_experiments(const ExperimentOptions& options, const CommonOptions& common, Console& console) {
  if (options.list) return list_experiments(options);
  if (options.grids.names.empty()) throw_option_error("NAME is missing; --list shows the experiments");
  if (options.out.empty()) throw_option_error("--out is missing");
  GridChoice choice = options.grids;
  choice.folder = experiments_directory();
  choice.data = options.data;
  const Result<std::vector<Grid>> grids = read_grids(choice);
  if (!grids) return grids.failure();
  Result<ExperimentDirectory> directory = ExperimentDirectory::create(options.out, options.resume);
  if (!directory) return directory.failure();

  Outcome outcome;
  outcome.is_answer = true;
  outcome.json = run_facts(common.program);
  outcome.json["out"] = options.out;
  outcome.json["experiments"] = nlohmann::ordered_json::object();
  const RunContext context = context_of(console);
  TrackingRuns tracking([&](const std::string& model) { return choose_body(model, context); }, options.data,
                        context.data / "networks");
  const Runner runner = [&](const RunSettings& settings, uint64_t seed, const std::function<bool()>& go_on) {
    return tracking.run(settings, seed, go_on);
  };
  std::vector<std::string> names;
  for (const Grid& grid : *grids) {
    const auto runs = run_grid(grid, {.first_seed = common.program.seed, .seeds = grid.seeds},
                               directory->path(grid.name), runner, &console);
    if (!runs) return error("{} (finished runs are in {}.partial, for --resume)", runs.error().message, options.out);
    if (!*runs) {
      outcome.interrupted = true;
      outcome.is_answer = false;
      outcome.text = fmt::format("interrupted; finished runs are in {}.partial, for --resume", options.out);
      return outcome;
    }
    const Result<ResultTable> table = write_results(directory->path(grid.name), grid, **runs,
                                                    {.command = common.program.command_line,
                                                     .commit = SILPOSE_COMMIT,
                                                     .machine = machine_name(),
                                                     .seed = common.program.seed,
                                                     .seeds = grid.seeds,
                                                     .quick = choice.quick});
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
  app->add_option("NAME", options->grids.names,
                  "Experiments named by --list, or all, or .toml files that describe one");
  app->add_option("--out", options->out, "Directory for the results, one folder per experiment");
  app->add_flag("--list", options->list, "List the available experiments");
  app->add_flag("--quick", options->grids.quick, "A small part of each, to check that it works");
  app->add_option("--seeds", options->grids.seeds,
                  "How many seeds, counted from --seed; default: as the experiment says")
      ->check(CLI::Range(1, 10'000));
  app->add_flag("--resume", options->resume, "Resume from the runs in DIR.partial");
  app->add_option("--data", options->data,
                  "Folder of motion-capture files or recorded clips, for experiments that need them");
  return {app, [options, &common](Console& console) { return run_experiments(*options, common, console); }};
}

}  // namespace silpose::app
