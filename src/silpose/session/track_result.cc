#include "silpose/session/track_result.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "silpose/report/report_page.h"
#include "silpose/session/result_files.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

std::string line_of(const PinholeCamera& camera) {
  const Eigen::Vector3d centre = camera.centre_in_world();
  return fmt::format("{}: {}x{} pixels, focal length {:.0f}, at ({:.2f}, {:.2f}, {:.2f}) m", camera.name, camera.width,
                     camera.height, camera.fx, centre.x(), centre.y(), centre.z());
}

FactLines run_lines(const FinishedTrack& track) {
  const TrackJob& job = track.job;
  const std::string camera_file = job.options.camera.has_file() ? job.options.camera.file
                                  : job.cameras.estimate        ? "none: estimated"
                                                                : "none: assumed";
  FactLines lines = {{"Command", track.program.command_line},
                     {"Version", track.program.version},
                     {"Machine", machine_name()},
                     {"Body", track.result.body->name},
                     {"Camera file", camera_file}};
  for (const PinholeCamera& camera : job.cameras.cameras) lines.emplace_back("Camera", line_of(camera));
  lines.emplace_back("Preset", job.options.preset);
  for (const auto& [name, value] : track.chosen) lines.emplace_back(name, value);
  lines.emplace_back("Seed", std::to_string(job.options.seed));
  for (const std::string& line : track.result.doubtful) lines.emplace_back("Doubtful", line);
  lines.emplace_back("Frames per second", fmt::format("{:.2f}", frames_per_second(track.result)));
  return lines;
}

// How the masks were made: the segmenter and its options.
FactLines mask_lines(const SegmentationOptions& options, const std::string& segmenter) {
  FactLines lines = {{"Segmenter", segmenter}};
  const auto add = [&](const char* name, const std::vector<std::string>& values) {
    if (!values.empty()) lines.emplace_back(name, fmt::format("{}", fmt::join(values, ", ")));
  };
  add("Background", options.backgrounds);
  add("Masks", options.masks);
  if (options.segmenter == "chroma") lines.emplace_back("Key colour", options.key_colour);
  add("Depth", options.depths);
  if (options.depth_range_m)
    lines.emplace_back("Depth range", fmt::format("{}", fmt::join(*options.depth_range_m, ",")));
  add("Region", options.regions);
  add("Garbage mask", options.garbage_masks);
  if (options.grow_px != 0) lines.emplace_back("Grown by", fmt::format("{} px", options.grow_px));
  if (options.min_blob_px) lines.emplace_back("Least blob", fmt::format("{} px", *options.min_blob_px));
  return lines;
}

}  // namespace

double frames_per_second(const SessionResult& result) { return static_cast<double>(result.num_frames) / result.loop_s; }

nlohmann::ordered_json facts_of(const FinishedTrack& track, const std::string& out) {
  const SessionResult& result = track.result;
  const CameraChoice& cameras = track.job.cameras;
  const ObservationSource& source = *track.job.source;
  const RecordingSummary summary = summarise(result.recording);
  nlohmann::ordered_json run = run_facts(track.program);
  run["model"] = track.job.options.model;
  run["body"] = result.body->name;
  run["size_deviation"] = result.used.size_deviation;
  if (result.body_fit && !result.recording.steps.empty()) run["fitted"] = facts_of(*result.body_fit);
  if (cameras.focal) run["focal_prior"] = facts_of(*cameras.focal);
  if (cameras.estimate) run["camera_estimate"] = facts_of(*cameras.estimate);
  run["frames"] = result.num_frames;
  run["frames_tracked"] = summary.frames_tracked;
  run["frames_coasted"] = summary.frames_coasted;
  run["stages_s"] = nlohmann::ordered_json::object();
  for (const auto& [stage, seconds] : result.seconds.list()) run["stages_s"][stage] = seconds;
  run["frames_per_second"] = frames_per_second(result);
  run["visual_accuracy"] = figure(summary.visual_accuracy_mean, summary.visual_accuracy_std);
  run["background"] = source.segmentation();
  run["start_by_landmarks"] = result.used.landmarks;
  run["evidence"] = source.finds_keypoints() ? text_of(named_options(result.used).at("evidence")) : "silhouette";
  run["cameras"] = nlohmann::ordered_json::array();
  for (const PinholeCamera& camera : cameras.cameras) run["cameras"].push_back(camera.name);
  run["doubtful"] = result.doubtful;
  run["warnings"] = track.warnings;
  run["out"] = out;
  return run;
}

Result<void> write_track_report(const FinishedTrack& track, const std::filesystem::path& folder) {
  const TrackJob& job = track.job;
  const std::vector<PinholeCamera>& cameras = job.cameras.cameras;
  ReportInput report;
  for (const std::string& video : job.options.input.videos) {
    const std::string name = std::filesystem::path(video).filename().string();
    report.title += (report.title.empty() ? "" : ", ") + (name.empty() ? video : name);
  }
  report.recording = &track.result.recording;
  report.body = track.result.body.get();
  report.viewpoint = cameras[0].centre_in_world();
  // Not there where drawing it was interrupted before its first image.
  if (std::filesystem::exists(folder / kOverlayFile)) report.overlay_video = folder / kOverlayFile;
  report.fps = job.source->video().fps();
  report.stages_s = track.result.seconds.list();
  report.warnings = track.warnings;
  report.facts = run_lines(track);
  report.mask_facts = mask_lines(job.options.input.segmentation, job.source->segmentation());
  for (size_t c = 0; c < cameras.size(); ++c) {
    report.strips.emplace_back(cameras[c].name, track.masks.strips()[c].examples());
  }
  for (const ResultFile& file : kResultFiles) {
    if (file.content.empty() || !std::filesystem::exists(folder / file.name)) continue;
    report.downloads.emplace_back(file.name, file.content);
  }
  return write_report(folder / "report.html", report);
}

}  // namespace silpose
