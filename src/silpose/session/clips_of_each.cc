#include "silpose/session/clips_of_each.h"

#include <map>
#include <system_error>
#include <utility>

#include "silpose/base/option_error.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

std::string name_of(const std::string& video) {
  if (!live_input({video}).empty()) throw_option_error("--each: {} is live; give recorded clips", video);
  const fs::path path = fs::path(video).has_filename() ? fs::path(video) : fs::path(video).parent_path();
  std::error_code failed;
  const fs::path name = fs::is_directory(path, failed) ? path.filename() : path.stem();
  if (name.empty() || name == "." || name == "..") throw_option_error("--each: {} has no name", video);
  return name.string();
}

void check_each(const TrackOptions& options) {
  const SegmentationOptions& segmentation = options.input.segmentation;
  const std::pair<const char*, size_t> per_camera[] = {{"--camera-name", options.camera.names.size()},
                                                       {"--background", segmentation.backgrounds.size()},
                                                       {"--region", segmentation.regions.size()},
                                                       {"--garbage-mask", segmentation.garbage_masks.size()}};
  for (const auto& [name, count] : per_camera) {
    if (count > 1) throw_option_error("{}: with --each every clip has one camera; give it once", name);
  }
  if (!segmentation.masks.empty()) throw_option_error("--masks: belong to one clip; not together with --each");
}

}  // namespace

std::vector<ClipOfEach> clips_of_each(const TrackOptions& options, const fs::path& out) {
  check_each(options);
  std::map<std::string, std::string> video_of;
  std::vector<ClipOfEach> clips;
  for (const std::string& video : options.input.videos) {
    const std::string name = name_of(video);
    const auto [other, is_new] = video_of.emplace(name, video);
    if (!is_new) throw_option_error("--each: {} and {} have one name", other->second, video);
    ClipOfEach& clip = clips.emplace_back(ClipOfEach{options, out / name});
    clip.options.input.videos = {video};
  }
  return clips;
}

}  // namespace silpose
