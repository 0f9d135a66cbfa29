// silpose model fit: a subject's own body from a clip.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/body_facts.h"
#include "apps/silpose/command.h"
#include "apps/silpose/shared_options.h"
#include "silpose/session/run_facts.h"
#include "silpose/session/subject_fit.h"

namespace silpose::app {
namespace {

struct FitOptions {
  SubjectFitOptions subject;
  std::string out;
};

// "lengths of 12 bones and 12 girths: 1.770 m, 71.2 kg".
std::string summary_of(const BodyFit& fit) {
  std::string what;
  if (fit.size) {
    what = fmt::format("size by the floor, {:+.1f} % (deviation over frames {:.1f} %)", 100 * (fit.size->factor - 1),
                       100 * fit.size->deviation);
  }
  if (!fit.lengths.empty()) {
    what += fmt::format("{}lengths of {} bones and {} girths", what.empty() ? "" : ", ", fit.lengths.size(),
                        fit.girths.size());
  }
  return fmt::format("{}: {:.3f} m, {:.1f} kg", what, fit.body->height_m, fit.body->weight_kg);
}

Result<Outcome> run_fit(const FitOptions& options, const CommonOptions& common, Console& console) {
  SubjectFitOptions fitting = options.subject;
  fitting.seed = common.program.seed;
  fitting.check();
  const std::filesystem::path folder = std::filesystem::absolute(options.out).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    return error("--out {}: there is no folder {}", options.out, folder.string());
  }
  const Result<SubjectFit> subject = fit_subject(fitting, context_of(console));
  if (!subject) return subject.failure();
  for (const std::string& warning : subject->warnings) console.warning(warning);
  Result<Outcome> outcome = write_model(*subject->fit.body, options.out);
  if (!outcome) return outcome.failure();
  outcome->json["fitted"] = silpose::facts_of(subject->fit);
  outcome->json["warnings"] = subject->warnings;
  outcome->text = summary_of(subject->fit) + "\n" + outcome->text;
  return outcome;
}

}  // namespace

Command add_model_fit(CLI::App& model, const CommonOptions& common) {
  const auto options = std::make_shared<FitOptions>();
  CLI::App* const fit = model.add_subcommand(
      "fit",
      "A subject's own body: bones and girths by several cameras, or by one and keypoints; the size by a known floor");
  add_input_options(*fit, options->subject.input);
  add_camera_options(*fit, options->subject.camera);
  add_model_option(*fit, options->subject.model);
  add_body_file_option(*fit, options->out);
  return {fit, [options, &common](Console& console) { return run_fit(*options, common, console); }};
}

}  // namespace silpose::app
