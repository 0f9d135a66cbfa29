#include "silpose/experiment/run_settings.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace silpose {

bool is_motion_file(const std::string& motion) { return std::filesystem::path(motion).has_extension(); }

std::string settings_text(const RunSettings& settings) {
  nlohmann::ordered_json json;
  const auto optional = [](const auto& value) { return value ? nlohmann::ordered_json(*value) : nullptr; };
  json["model"] = settings.model;
  json["motion"] = settings.motion;
  json["frames"] = settings.frames;
  json["fps"] = settings.fps;
  json["amplitude_deg"] = optional(settings.amplitude_deg);
  json["period_s"] = optional(settings.period_s);
  json["range"] = optional(settings.range);
  json["views"] = settings.views;
  json["size"] = {settings.width, settings.height};
  json["focal_px"] = settings.focal_px;
  json["distance_m"] = settings.distance_m;
  json["mask_noise"] = settings.mask_noise;
  json["mask_iou"] = settings.mask_iou;
  if (settings.faults_known) json["faults_known"] = true;  // results from before there was a choice stay good
  if (settings.drawn_person) json["drawn_person"] = true;
  if (settings.keypoints) json["keypoints"] = true;
  if (settings.keypoints || settings.is_recorded()) json["evidence"] = settings.evidence;
  if (settings.fit_body) json["fit_body"] = true;
  if (settings.is_recorded()) {
    json["clip"] = settings.clip;
    json["camera"] = settings.camera;
    json["camera_names"] = settings.camera_names;
    json["truth"] = settings.truth;
    json["truth_above"] = optional(settings.truth_above);
    json["segmenter"] = settings.segmenter;
    json["background"] = settings.background;
    json["floor"] = optional(settings.floor);
  }
  json["preset"] = settings.preset;
  json["smooth"] = optional(settings.smooth);
  json["hypotheses"] = optional(settings.hypotheses);
  json["particles"] = optional(settings.particles);
  json["layers"] = optional(settings.layers);
  json["vertices"] = optional(settings.vertices);
  json["body_height"] = settings.body_height;
  json["body_weight"] = settings.body_weight;
  json["start"] = settings.start;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace silpose
