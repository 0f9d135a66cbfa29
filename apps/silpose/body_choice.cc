#include "apps/silpose/body_choice.h"

#include <fmt/format.h>

#include <system_error>

#include "apps/silpose/command.h"
#include "apps/silpose/data_folder.h"
#include "silpose/base/whole_file.h"
#include "silpose/human/human.h"
#include "silpose/render/body_levels.h"

namespace silpose::app {
namespace {

namespace fs = std::filesystem;

bool is_human(const std::string& model) { return model == "human" || model.starts_with("human:"); }

// The model without `dof=`, which names the skeleton rather than the person.
std::string without_dof(const std::string& model) {
  const size_t start = model.find("dof=");
  if (start == std::string::npos) return model;
  const size_t comma = model.find(',', start);
  const std::string dof = model.substr(start + 4, comma == std::string::npos ? comma : comma - start - 4);
  if (dof != "37") throw UsageError(fmt::format("--model {}: dof={} is not supported, only dof=37", model, dof));
  std::string rest = model.substr(0, start);
  if (comma != std::string::npos) return rest + model.substr(comma + 1);
  if (rest.ends_with(',') || rest.ends_with(':')) rest.pop_back();
  return rest;
}

std::string file_name_of(std::string model) {
  for (char& c : model) {
    if (c == ':' || c == ',' || c == '/' || c == ' ') c = '_';
  }
  return model + ".body";
}

// True when `body_file` is there and neither the program nor the body data is newer.
bool is_up_to_date(const fs::path& body_file) {
  std::error_code failed;
  const auto made = fs::last_write_time(body_file, failed);
  if (failed) return false;
  for (const fs::path& source :
       {fs::read_symlink("/proc/self/exe", failed), data_directory() / "makehuman/SHA256SUMS"}) {
    const auto changed = fs::last_write_time(source, failed);
    if (!failed && changed > made) return false;
  }
  return true;
}

}  // namespace

CLI::Validator is_model() {
  return CLI::Validator(
      [](const std::string& model) -> std::string {
        if (fs::path(model).extension() == ".body") return "";
        if (!is_human(model))
          return fmt::format("{}: unknown model (human, human:key=value,... or a .body file)", model);
        try {
          const Result<Phenotype> phenotype = parse_phenotype(without_dof(model));
          return phenotype ? "" : phenotype.error().message;
        } catch (const UsageError& wrong) {
          return wrong.what();
        }
      },
      "");
}

void add_model_option(CLI::App& command, std::string& model) {
  command
      .add_option(
          "--model", model,
          "The body: human, human:age=30,sex=f,height=1.62,weight=58,muscle=0.5 (years, m, kg), or a .body file")
      ->capture_default_str()
      ->check(is_model());
}

std::optional<BodyModel> kept_human(const fs::path& body_file) {
  if (!is_up_to_date(body_file)) return std::nullopt;
  Result<BodyModel> body = load_body(body_file);
  if (!body || !has_present_joint_places(*body)) return std::nullopt;
  return std::move(*body);
}

Result<BodyModel> build_body(const std::string& model, Console& console) {
  if (!is_human(model)) return error("--model {}: unknown model (human, human:key=value,... or a .body file)", model);
  const Result<Phenotype> phenotype = parse_phenotype(without_dof(model));
  if (!phenotype) return error("--model {}: {}", model, phenotype.error().message);
  console.message(fmt::format("building the body {}", model));
  const Result<MakeHumanData> data = MakeHumanData::load(data_directory() / "makehuman");
  if (!data) return data.failure();
  Result<BodyModel> body = build_human(*data, *phenotype);
  if (!body) return error("--model {}: {}", model, body.error().message);
  console.message("building its levels of detail");
  add_levels(*body);
  return body;
}

double size_deviation_of(const std::string& model) {
  return is_human(model) ? stature_deviation(parse_phenotype(without_dof(model)).value()) : 0;
}

Result<std::shared_ptr<const BodyModel>> choose_body(const std::string& model, Console& console) {
  if (fs::path(model).extension() == ".body") {
    Result<BodyModel> body = load_body(model);
    if (!body) return body.failure();
    return std::make_shared<const BodyModel>(std::move(*body));
  }
  const std::string person = is_human(model) ? without_dof(model) : model;
  const fs::path kept =
      person == "human" ? data_directory() / "human.body" : data_directory() / "bodies" / file_name_of(person);
  if (is_human(model)) {
    if (std::optional<BodyModel> body = kept_human(kept)) return std::make_shared<const BodyModel>(std::move(*body));
  }
  Result<BodyModel> body = build_body(person, console);
  if (!body) return body.failure();
  // Keeping it is a convenience: where the data directory is read-only, the body is built again next time.
  (void)write_whole(kept, [&](const fs::path& path) { return write_body(path, *body); });
  return std::make_shared<const BodyModel>(std::move(*body));
}

}  // namespace silpose::app
