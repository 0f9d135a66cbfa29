#include "apps/silpose/track_result.h"

#include <fmt/format.h>

#include "apps/silpose/body_fit_facts.h"
#include "apps/silpose/clip_camera_choice.h"
#include "apps/silpose/run_facts.h"
#include "silpose/report/report_page.h"
#include "silpose/session/result_files.h"
#include "silpose/track/tracker_presets.h"

namespace silpose::app {
namespace {

double frames_per_second(const SessionResult& tracked) {
  return static_cast<double>(tracked.num_frames) / tracked.loop_s;
}

std::string line_of(const PinholeCamera& camera) {
  const Eigen::Vector3d centre = camera.centre_in_world();
  return fmt::format("{}: {}x{} pixels, focal length {:.0f}, at ({:.2f}, {:.2f}, {:.2f}) m", camera.name, camera.width,
                     camera.height, camera.fx, centre.x(), centre.y(), centre.z());
}

FactLines run_lines(const FinishedTrack& finished) {
  const std::string camera_file = finished.options.camera.has_file() ? finished.options.camera.file
                                  : finished.camera.estimate         ? "none: estimated"
                                                                     : "none: assumed";
  FactLines lines = {{"Command", finished.common.command_line},
                     {"Version", SILPOSE_VERSION},
                     {"Machine", machine_name()},
                     {"Body", finished.tracked.body->name},
                     {"Camera file", camera_file}};
  for (const PinholeCamera& camera : finished.camera.cameras) lines.emplace_back("Camera", line_of(camera));
  lines.emplace_back("Preset", finished.options.preset);
  for (const auto& [name, value] : chosen_options(finished.options, finished.tracked.used))
    lines.emplace_back(name, value);
  lines.emplace_back("Seed", std::to_string(finished.common.seed));
  for (const std::string& line : finished.tracked.doubtful) lines.emplace_back("Doubtful", line);
  lines.emplace_back("Frames per second", fmt::format("{:.2f}", frames_per_second(finished.tracked)));
  return lines;
}

// How the masks were made: the segmenter and its options.
FactLines mask_lines(const InputOptions& options, const ObservationSource& source) {
  FactLines lines = {{"Segmenter", source.segmentation()}};
  const auto add = [&](const char* name, const std::vector<std::string>& values) {
    if (!values.empty()) lines.emplace_back(name, fmt::format("{}", fmt::join(values, ", ")));
  };
  add("Background", options.backgrounds);
  add("Masks", options.masks);
  if (options.segmenter == "chroma") lines.emplace_back("Key colour", options.key_colour);
  add("Depth", options.depths);
  if (!options.depth_range.empty()) lines.emplace_back("Depth range", options.depth_range);
  add("Region", options.regions);
  add("Garbage mask", options.garbage_masks);
  if (options.grow_px != 0) lines.emplace_back("Grown by", fmt::format("{} px", options.grow_px));
  if (options.min_blob_px) lines.emplace_back("Least blob", fmt::format("{} px", *options.min_blob_px));
  return lines;
}

}  // namespace

Outcome track_outcome(const FinishedTrack& finished, const std::filesystem::path& folder) {
  const SessionResult& tracked = finished.tracked;
  const RecordingSummary summary = summarise(tracked.recording);
  Outcome outcome;
  outcome.interrupted = tracked.stopped;
  nlohmann::ordered_json& run = outcome.json;
  run = run_facts(finished.common);
  run["model"] = finished.options.model;
  run["body"] = finished.tracked.body->name;
  run["size_deviation"] = tracked.used.size_deviation;
  if (tracked.body_fit && !tracked.recording.steps.empty()) run["fitted"] = facts_of(*tracked.body_fit);
  if (finished.camera.focal) run["focal_prior"] = facts_of(*finished.camera.focal);
  if (finished.camera.estimate) run["camera_estimate"] = facts_of(*finished.camera.estimate);
  run["frames"] = tracked.num_frames;
  run["frames_tracked"] = summary.frames_tracked;
  run["frames_coasted"] = summary.frames_coasted;
  run["stages_s"] = nlohmann::ordered_json::object();
  for (const auto& [stage, seconds] : tracked.seconds.list()) run["stages_s"][stage] = seconds;
  run["frames_per_second"] = frames_per_second(tracked);
  run["visual_accuracy"] = figure(summary.visual_accuracy_mean, summary.visual_accuracy_std);
  run["background"] = finished.source.segmentation();
  run["start_by_landmarks"] = tracked.used.landmarks;
  run["evidence"] =
      finished.source.finds_keypoints() ? text_of(named_options(tracked.used).at("evidence")) : "silhouette";
  run["cameras"] = nlohmann::ordered_json::array();
  for (const PinholeCamera& camera : finished.camera.cameras) run["cameras"].push_back(camera.name);
  run["doubtful"] = tracked.doubtful;
  run["warnings"] = finished.warnings;
  run["out"] = finished.options.out;

  outcome.text = fmt::format("{} frames, {} tracked, {} coasted; {:.1f} frames per second\n", tracked.num_frames,
                             summary.frames_tracked, summary.frames_coasted, frames_per_second(tracked));
  if (summary.frames_tracked > 0) {
    outcome.text += fmt::format("visual accuracy {:.3f} \u00b1 {:.3f}\n", summary.visual_accuracy_mean,
                                summary.visual_accuracy_std);
  }
  if (tracked.recording.steps.empty()) {
    outcome.text += fmt::format("masks: {}", folder.string());
  } else {
    outcome.text += fmt::format("overlay: {0}/overlay.mp4\nreport:  {0}/report.html", folder.string());
  }
  if (tracked.body_fit && !tracked.recording.steps.empty()) {
    outcome.text += fmt::format("\nbody:    {}/{}, {:.3f} m tall", folder.string(), kFittedBodyFile,
                                finished.tracked.body->height_m);
  }
  return outcome;
}

Result<void> write_track_report(const FinishedTrack& finished, const std::filesystem::path& folder) {
  const std::vector<PinholeCamera>& cameras = finished.camera.cameras;
  ReportInput report;
  for (const std::string& video : finished.options.input.videos) {
    const std::string name = std::filesystem::path(video).filename().string();
    report.title += (report.title.empty() ? "" : ", ") + (name.empty() ? video : name);
  }
  report.recording = &finished.tracked.recording;
  report.body = finished.tracked.body.get();
  report.viewpoint = cameras[0].centre_in_world();
  // Not there where drawing it was interrupted before its first picture.
  if (std::filesystem::exists(folder / kOverlayFile)) report.overlay_video = folder / kOverlayFile;
  report.fps = finished.source.video().fps();
  report.stages_s = finished.tracked.seconds.list();
  report.warnings = finished.warnings;
  report.facts = run_lines(finished);
  report.mask_facts = mask_lines(finished.options.input, finished.source);
  for (size_t c = 0; c < cameras.size(); ++c) {
    report.strips.emplace_back(cameras[c].name, finished.masks.strips()[c].examples());
  }
  for (const ResultFile& file : kResultFiles) {
    if (file.content.empty() || !std::filesystem::exists(folder / file.name)) continue;
    report.downloads.emplace_back(file.name, file.content);
  }
  return write_report(folder / "report.html", report);
}

}  // namespace silpose::app
