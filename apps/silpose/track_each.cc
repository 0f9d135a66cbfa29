#include "apps/silpose/track_each.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <system_error>

#include "silpose/session/result_directory.h"

namespace silpose::app {
namespace {

namespace fs = std::filesystem;

// "walks/one.mp4" is "one"; a folder keeps its name.
std::string name_of(const std::string& video) {
  if (video.starts_with("camera:")) throw UsageError(fmt::format("--each: {} is live; give recorded clips", video));
  const fs::path path = fs::path(video).has_filename() ? fs::path(video) : fs::path(video).parent_path();
  std::error_code failed;
  const fs::path name = fs::is_directory(path, failed) ? path.filename() : path.stem();
  if (name.empty() || name == "." || name == "..") throw UsageError(fmt::format("--each: {} has no name", video));
  return name.string();
}

void check_each(const TrackOptions& options) {
  const std::pair<const char*, size_t> per_camera[] = {{"--camera-name", options.camera.names.size()},
                                                       {"--background", options.input.backgrounds.size()},
                                                       {"--region", options.input.regions.size()},
                                                       {"--garbage-mask", options.input.garbage_masks.size()}};
  for (const auto& [name, count] : per_camera) {
    if (count > 1) throw UsageError(fmt::format("{}: with --each every clip has one camera; give it once", name));
  }
  if (!options.input.masks.empty()) throw UsageError("--masks: belong to one clip; not together with --each");
}

}  // namespace

Result<Outcome> track_each(const TrackOptions& options, Console& console,
                           const std::function<Result<Outcome>(const TrackOptions&)>& track) {
  check_each(options);
  std::map<std::string, std::string> video_of;
  for (const std::string& video : options.input.videos) {
    const auto [other, is_new] = video_of.emplace(name_of(video), video);
    if (!is_new) throw UsageError(fmt::format("--each: {} and {} have one name", other->second, video));
  }

  Outcome outcome;
  nlohmann::ordered_json clips = nlohmann::ordered_json::array();
  std::string failures;
  size_t num_done = 0, num_there = 0, num_failed = 0;
  for (const std::string& video : options.input.videos) {
    TrackOptions of_clip = options;
    of_clip.input.videos = {video};
    const fs::path out = fs::path(options.out) / name_of(video);
    of_clip.out = out.string();
    nlohmann::ordered_json clip = {{"video", video}, {"out", out.string()}};
    if (options.resume && is_whole_result(out)) {
      ++num_there;
      clips.push_back(std::move(clip));
      continue;
    }
    console.message(fmt::format("{} ({} of {})", video, clips.size() + 1, options.input.videos.size()));
    Result<Outcome> tracked = track(of_clip);
    if (Console::interrupted()) {
      outcome.interrupted = true;
      if (!tracked) console.error("interrupted; continue with --resume");
      break;
    }
    if (tracked) {
      ++num_done;
      clip["result"] = std::move(tracked->json);
    } else {
      ++num_failed;
      const std::string& message = tracked.error().message;
      console.error(message);
      failures += fmt::format("\nfailed: {}: {}", video, message);
      clip["error"] = message;
    }
    clips.push_back(std::move(clip));
  }
  outcome.failed = num_failed > 0;
  outcome.json["clips"] = std::move(clips);
  outcome.text = fmt::format("{} of {} clips tracked", num_done, options.input.videos.size());
  if (num_there > 0) outcome.text += fmt::format(", {} were there already", num_there);
  outcome.text += failures;
  return outcome;
}

}  // namespace silpose::app
