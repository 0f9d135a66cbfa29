#include "apps/silpose/track_checkpoint.h"

#include <fmt/format.h>

#include <algorithm>

#include "silpose/base/checked_file.h"
#include "silpose/base/state_bytes.h"
#include "silpose_commit.h"

namespace silpose::app {
namespace {

constexpr FileKind kCheckpoint{.magic = "SILPTRAK", .version = 4, .name = "checkpoint of silpose track"};

std::string bytes_of(const PinholeCamera& camera) {
  return to_bytes(camera.name, camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                  camera.distortion, camera.cam_from_world.rotation, camera.cam_from_world.translation);
}

std::string bytes_of(const BodyModel& body) {
  std::string bytes = to_bytes(body.name, body.rest.vertices);
  for (const Dof& dof : body.skeleton.dofs()) bytes += to_bytes(dof.lower, dof.upper);
  for (const Joint& joint : body.skeleton.joints()) bytes += to_bytes(joint.offset_in_parent);
  return bytes;
}

// The first entry that differs between the lists, or that one of them lacks.
std::optional<std::string> difference(const OptionLines& earlier, const OptionLines& now) {
  const auto value_in = [](const OptionLines& lines, const std::string& key) {
    const auto found = std::ranges::find(lines, key, &OptionLines::value_type::first);
    return found == lines.end() ? std::string("not given") : found->second;
  };
  for (const OptionLines* lines : {&now, &earlier}) {
    for (const auto& [key, value] : *lines) {
      const std::string before = value_in(earlier, key), here = value_in(now, key);
      if (before != here) return fmt::format("{}: was {}, now {}", key, before, here);
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::pair<std::string, double>> StageSeconds::list() const {
  return {{"camera", camera},         {"background", background},
          {"decode", decode},         {"segment", segment},
          {"start", start},           {"propagate", propagate},
          {"likelihood", likelihood}, {"resample", resample},
          {"smooth", smooth},         {"write", write}};
}

OptionLines made_with(OptionLines options, const std::vector<PinholeCamera>& cameras, const BodyModel& body) {
  for (auto& [key, value] : options) {
    if (key == "video") {
      key = "VIDEO";
    } else {
      key.insert(0, "--");
    }
  }
  std::string of_cameras;
  for (const PinholeCamera& camera : cameras) of_cameras += bytes_of(camera);
  options.emplace_back("the cameras (checksum)", fmt::format("{:08x}", checksum(of_cameras)));
  options.emplace_back("the body (checksum)", fmt::format("{:08x}", checksum(bytes_of(body))));
  options.emplace_back("silpose", SILPOSE_VERSION " " SILPOSE_COMMIT);
  return options;
}

uint32_t picture_checksum(const Frame& frame) {
  constexpr int kEvery = 16;  // rows
  std::string rows;
  for (const ByteImage& image : frame.images) {
    rows += to_bytes(image.width(), image.height());
    for (int y = 0; y < image.height(); y += kEvery) rows.append(image.row(y).begin(), image.row(y).end());
  }
  return checksum(rows);
}

Result<void> write_checkpoint(const std::filesystem::path& folder, const OptionLines& made_with,
                              const TrackCheckpoint& checkpoint) {
  return write_checked_file(folder / kCheckpointFile, kCheckpoint, to_bytes(made_with, to_bytes(checkpoint)));
}

Result<std::optional<TrackCheckpoint>> read_checkpoint(const std::filesystem::path& folder,
                                                       const OptionLines& made_with) {
  const std::filesystem::path path = folder / kCheckpointFile;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::optional<TrackCheckpoint>();
  const Result<std::string> bytes = read_checked_file(path, kCheckpoint);
  if (!bytes) return error("--resume: {}; without --resume the clip is tracked from the start", bytes.error().message);
  OptionLines earlier;
  std::string state;
  if (!from_bytes(*bytes, earlier, state)) return error("--resume: {}: malformed", path.string());
  if (const std::optional<std::string> other = difference(earlier, made_with)) {
    return error("--resume: {} can only be resumed as it was started; {}", folder.string(), *other);
  }
  std::optional<TrackCheckpoint> checkpoint(std::in_place);
  if (!from_bytes(state, *checkpoint)) return error("--resume: {}: malformed", path.string());
  return checkpoint;
}

}  // namespace silpose::app
