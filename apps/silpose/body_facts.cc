#include "apps/silpose/body_facts.h"

#include <fmt/format.h>

#include "silpose/base/whole_file.h"

namespace silpose::app {

namespace fs = std::filesystem;

nlohmann::ordered_json facts_of(const BodyModel& body) {
  nlohmann::ordered_json json;
  json["name"] = body.name;
  json["skeleton"] = body.skeleton.name();
  json["joints"] = body.skeleton.num_joints();
  json["dofs"] = body.skeleton.num_dofs();
  json["vertices"] = body.rest.vertices.size();
  json["faces"] = body.rest.faces.size();
  json["closed"] = is_closed(body.rest.faces);
  json["height_m"] = body.height_m;
  json["weight_kg"] = body.weight_kg;
  json["facts"] = body.facts;
  nlohmann::ordered_json levels = nlohmann::json::array();
  for (const BodyLevel& level : body.levels) {
    levels.push_back({{"asked_vertices", level.asked_vertices},
                      {"vertices", level.vertices.size()},
                      {"faces", level.faces.size()},
                      {"mean_iou", level.mean_iou},
                      {"worst_iou", level.worst_iou}});
  }
  json["levels"] = levels;
  return json;
}

std::string summary_of(const BodyModel& body) {
  return fmt::format("{}: {} joints, {} DOF, {} vertices, {} faces, {:.3f} m, {:.1f} kg", body.name,
                     body.skeleton.num_joints(), body.skeleton.num_dofs(), body.rest.vertices.size(),
                     body.rest.faces.size(), body.height_m, body.weight_kg);
}

Result<Outcome> write_model(const BodyModel& body, const std::string& out) {
  const Result<void> written = write_whole(out, [&](const fs::path& path) { return write_body(path, body); });
  if (!written) return written.failure();
  Outcome outcome;
  outcome.json = facts_of(body);
  outcome.json["out"] = out;
  outcome.text = fmt::format("{}\nwritten to {}", summary_of(body), out);
  return outcome;
}

}  // namespace silpose::app
