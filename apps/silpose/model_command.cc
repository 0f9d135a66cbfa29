// silpose model: body models: list them, build one, inspect one, make one coarser, fit one to a subject.
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "apps/silpose/body_facts.h"
#include "apps/silpose/command.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/data_folder.h"
#include "silpose/geometry/rigid3.h"
#include "silpose/render/body_levels.h"
#include "silpose/session/body_choice.h"

namespace silpose::app {
namespace {

namespace fs = std::filesystem;

Result<Outcome> list_models() {
  Outcome outcome;
  outcome.is_answer = true;
  outcome.json["models"] = {"human"};
  outcome.text = "human    20 joints, 37 DOF; human:age=YEARS,sex=f|m|0..1,height=M,weight=KG,muscle=0..1";
  nlohmann::ordered_json kept = nlohmann::json::array();
  std::error_code failed;
  for (const fs::path& folder : {data_directory(), data_directory() / "bodies"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
      if (entry.path().extension() != ".body") continue;
      kept.push_back(entry.path().string());
      outcome.text += "\n" + entry.path().string();
    }
  }
  outcome.json["files"] = kept;
  return outcome;
}

Result<Outcome> inspect_model(const std::string& model, Console& console) {
  const auto body = choose_body(model, context_of(console));
  if (!body) return body.failure();
  Outcome outcome;
  outcome.is_answer = true;
  outcome.json = facts_of(**body);
  outcome.text = summary_of(**body);
  for (const auto& [key, value] : (*body)->facts) outcome.text += fmt::format("\n  {}: {}", key, value);
  for (const BodyLevel& level : (*body)->levels) {
    outcome.text +=
        fmt::format("\n  level of {} vertices, {} faces: silhouettes share {:.4f} with the whole's, {:.4f} at least",
                    level.vertices.size(), level.faces.size(), level.mean_iou, level.worst_iou);
  }
  nlohmann::ordered_json dofs = nlohmann::json::array();
  for (const Dof& dof : (*body)->skeleton.dofs()) {
    const double lower = dof.is_translation ? dof.lower : to_degrees(dof.lower);
    const double upper = dof.is_translation ? dof.upper : to_degrees(dof.upper);
    dofs.push_back({{"column", dof.column()},
                    {"joint", (*body)->skeleton.joints()[static_cast<size_t>(dof.joint_idx)].name},
                    {"lower", lower},
                    {"upper", upper},
                    {"periodic", dof.is_periodic}});
    outcome.text += fmt::format("\n  {:24} {:8.2f} to {:8.2f}", dof.column(), lower, upper);
  }
  outcome.json["limits"] = dofs;
  return outcome;
}

struct ModelOptions {
  std::string model = "human", out;
  bool if_older = false;
  std::optional<int> vertices;
  std::optional<double> iou;
};

Result<Outcome> build_model(const ModelOptions& options, Console& console) {
  if (options.if_older) {
    const std::optional<BodyModel> kept = kept_human(options.out, data_directory());
    if (kept) return Outcome{.json = facts_of(*kept), .text = summary_of(*kept)};
  }
  const Result<BodyModel> body = build_body(options.model, context_of(console));
  if (!body) return body.failure();
  return write_model(*body, options.out);
}

Result<Outcome> model_with_levels(const ModelOptions& options, Console& console) {
  const auto body = choose_body(options.model, context_of(console));
  if (!body) return body.failure();
  if (options.vertices) return write_model(level_of_detail(**body, *options.vertices), options.out);
  BodyModel with_levels = **body;
  if (!options.iou || with_levels.levels.empty()) {
    console.message("building its levels of detail");
    add_levels(with_levels);
  }
  if (!options.iou) return write_model(with_levels, options.out);
  const Result<const BodyLevel*> level = choose_level(with_levels, *options.iou);
  if (!level) return level.failure();
  return write_model(body_of_level(with_levels, **level), options.out);
}

}  // namespace

std::vector<Command> add_model(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<ModelOptions>();
  CLI::App* const model = program.add_subcommand("model", "Body models");
  model->require_subcommand(1);

  CLI::App* const list = model->add_subcommand("list", "List the models");
  CLI::App* const build = model->add_subcommand("build", "Build a body and write it as a .body file");
  add_model_option(*build, options->model);
  add_body_file_option(*build, options->out);
  build->add_flag("--if-older", options->if_older,
                  "Only where the file is missing, older than the program or the data, or has joints in other places");
  CLI::App* const inspect = model->add_subcommand("inspect", "What a body is made of, and the limits of its DOF");
  inspect->add_option("MODEL,--model", options->model, "As --model of other commands")
      ->capture_default_str()
      ->check(is_model());
  CLI::App* const lod =
      model->add_subcommand("lod", "The same body with its levels of detail, or one of them as a body");
  add_model_option(*lod, options->model);
  add_body_file_option(*lod, options->out);
  CLI::Option* const vertices = lod->add_option("--vertices", options->vertices, "Only the level of about this many")
                                    ->check(CLI::Range(100, 20000));
  lod->add_option("--iou", options->iou,
                  "Only the coarsest level whose silhouettes share this much with the whole body's, on average")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes(vertices);

  return {
      {list, [](Console&) { return list_models(); }},
      {build, [options](Console& console) { return build_model(*options, console); }},
      {inspect, [options](Console& console) { return inspect_model(options->model, console); }},
      {lod, [options](Console& console) { return model_with_levels(*options, console); }},
      add_model_fit(*model, common),
  };
}

}  // namespace silpose::app
