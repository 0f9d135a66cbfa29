#include "silpose/session/body_choice.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "silpose/base/whole_file.h"
#include "silpose/human/human.h"
#include "silpose/render/body_levels.h"
#include "silpose/session/result_files.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

bool is_human(const std::string& model) { return model == "human" || model.starts_with("human:"); }
bool is_body_file(const std::string& model) { return fs::path(model).extension() == ".body"; }

// The human's model without `dof=`, which names the skeleton rather than the person. Errors: not a human; another
// skeleton; the caller puts the model in front.
Result<std::string> person_of(const std::string& model) {
  if (!is_human(model)) return error("unknown model (human, human:key=value,... or a .body file)");
  const size_t start = model.find("dof=");
  if (start == std::string::npos) return model;
  const size_t comma = model.find(',', start);
  const std::string dof = model.substr(start + 4, comma == std::string::npos ? comma : comma - start - 4);
  if (dof != "37") return error("dof={} is not supported, only dof=37", dof);
  std::string rest = model.substr(0, start);
  if (comma != std::string::npos) return rest + model.substr(comma + 1);
  if (rest.ends_with(',') || rest.ends_with(':')) rest.pop_back();
  return rest;
}

Result<Phenotype> phenotype_of(const std::string& model) {
  const Result<std::string> person = person_of(model);
  if (!person) return person.failure();
  return parse_phenotype(*person);
}

fs::path kept_file(const std::string& person, const fs::path& data) {
  if (person == "human") return data / "human.body";
  std::string name = person;
  for (char& c : name) {
    if (c == ':' || c == ',' || c == '/' || c == ' ') c = '_';
  }
  return data / "bodies" / (name + ".body");
}

// True when `body_file` is there and neither the program nor the body data is newer.
bool is_up_to_date(const fs::path& body_file, const fs::path& data) {
  std::error_code failed;
  const auto made = fs::last_write_time(body_file, failed);
  if (failed) return false;
  for (const fs::path& source : {fs::read_symlink("/proc/self/exe", failed), data / "makehuman/SHA256SUMS"}) {
    const auto changed = fs::last_write_time(source, failed);
    if (!failed && changed > made) return false;
  }
  return true;
}

}  // namespace

Result<void> check_model(const std::string& model) {
  if (is_body_file(model)) return {};
  const Result<std::string> person = person_of(model);
  if (!person) return error("{}: {}", model, person.error().message);
  const Result<Phenotype> phenotype = parse_phenotype(*person);
  return phenotype ? Result<void>() : phenotype.failure();
}

std::optional<BodyModel> kept_human(const fs::path& body_file, const fs::path& data) {
  if (!is_up_to_date(body_file, data)) return std::nullopt;
  Result<BodyModel> body = load_body(body_file);
  if (!body || !has_present_joint_places(*body)) return std::nullopt;
  return std::move(*body);
}

Result<BodyModel> build_body(const std::string& model, const RunContext& context) {
  const Result<Phenotype> phenotype = phenotype_of(model);
  if (!phenotype) return error("--model {}: {}", model, phenotype.error().message);
  context.tell(fmt::format("building the body {}", model));
  const Result<MakeHumanData> data = MakeHumanData::load(context.data / "makehuman");
  if (!data) return data.failure();
  Result<BodyModel> body = build_human(*data, *phenotype);
  if (!body) return error("--model {}: {}", model, body.error().message);
  context.tell("building its levels of detail");
  add_levels(*body);
  return body;
}

std::string model_of_result(const fs::path& directory) {
  if (const fs::path fitted = directory / kFittedBodyFile; fs::exists(fitted)) return fitted.string();
  std::ifstream file(directory / "run.json");
  const nlohmann::json run = nlohmann::json::parse(file, nullptr, false);
  if (!run.is_object() || !run.contains("model") || !run["model"].is_string()) return "human";
  return run["model"].get<std::string>();
}

double size_deviation_of(const std::string& model) {
  return is_body_file(model) ? 0 : stature_deviation(phenotype_of(model).value());
}

Result<std::shared_ptr<const BodyModel>> choose_body(const std::string& model, const RunContext& context) {
  if (is_body_file(model)) {
    Result<BodyModel> body = load_body(model);
    if (!body) return body.failure();
    return std::make_shared<const BodyModel>(std::move(*body));
  }
  const Result<std::string> person = person_of(model);
  if (!person) return error("--model {}: {}", model, person.error().message);
  const fs::path kept = kept_file(*person, context.data);
  if (std::optional<BodyModel> body = kept_human(kept, context.data)) {
    return std::make_shared<const BodyModel>(std::move(*body));
  }
  Result<BodyModel> body = build_body(*person, context);
  if (!body) return body.failure();
  // Keeping it is a convenience: where the data folder is read-only, the body is built again next time.
  (void)write_whole(kept, [&](const fs::path& path) { return write_body(path, *body); });
  return std::make_shared<const BodyModel>(std::move(*body));
}

}  // namespace silpose
