// silpose evaluate: errors of a result against a truth.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/command.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/option_error.h"
#include "silpose/evaluate/evaluation.h"
#include "silpose/session/body_choice.h"

namespace silpose::app {
namespace {

struct EvaluateCommandOptions {
  std::string result, truth, model;
  EvaluateOptions evaluation;
};

Result<Outcome> run_evaluate(const EvaluateCommandOptions& options, Console& console) {
  if (options.evaluation.end_s <= options.evaluation.start_s) throw_option_error("--start is not before --end");
  const std::string model = options.model.empty() ? model_of_result(options.result) : options.model;
  const auto body = choose_body(model, context_of(console));
  if (!body) return body.failure();
  const Result<Recorded> result = read_recorded(options.result, **body);
  if (!result) return result.failure();
  const Result<Recorded> truth = read_recorded(options.truth, **body);
  if (!truth) return truth.failure();
  const Result<Evaluation> evaluation = evaluate(*result, *truth, **body, options.evaluation);
  if (!evaluation) return evaluation.failure();
  if (evaluation->frames + evaluation->frames_missing == 0) {
    return error("{}: no frame between --start and --end", options.truth);
  }

  Outcome outcome;
  outcome.is_answer = true;
  outcome.json["frames"] = evaluation->frames;
  outcome.json["frames_missing"] = evaluation->frames_missing;
  outcome.text = fmt::format("{} frames, {} missing from the result", evaluation->frames, evaluation->frames_missing);
  for (const auto& [name, figure] : evaluation->figures) {
    if (figure) {
      outcome.json[name] = {{"mean", figure->mean}, {"std", figure->std}};
      outcome.text += fmt::format("\n  {:24} {:10.3f} \u00b1 {:.3f}", name, figure->mean, figure->std);
    } else {
      outcome.json[name] = nullptr;
      outcome.text += fmt::format("\n  {:24} {:>10}", name, "-");
    }
  }
  return outcome;
}

}  // namespace

Command add_evaluate(CLI::App& program, const CommonOptions&) {
  const auto options = std::make_shared<EvaluateCommandOptions>();
  CLI::App* const app = program.add_subcommand("evaluate", "Errors of a result against a truth");
  app->add_option("--result", options->result, "Directory of a result")->required();
  app->add_option("--truth", options->truth, "Directory of a truth")->required();
  app->add_option("--start", options->evaluation.start_s, "Seconds: only frames at or after this")
      ->check(within(-1e6, 1e6));
  app->add_option("--end", options->evaluation.end_s, "Seconds: only frames before this")->check(within(-1e6, 1e6));
  app->add_option("--model", options->model, "The body of the result; default: its own")->check(is_model());
  return {app, [options](Console& console) { return run_evaluate(*options, console); }};
}

}  // namespace silpose::app
