#include "silpose/session/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "silpose/base/checked_file.h"
#include "silpose/base/state_bytes.h"

namespace silpose {
namespace {

constexpr FileKind kCheckpoint{.magic = "SILPTRAK", .version = 6, .name = "checkpoint of silpose track"};

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
std::optional<std::string> difference(const MadeWith& earlier, const MadeWith& now) {
  const auto value_in = [](const MadeWith& entries, const std::string& name) {
    const auto found = std::ranges::find(entries, name, &MadeWith::value_type::first);
    return found == entries.end() ? std::string("not given") : found->second;
  };
  for (const MadeWith* entries : {&now, &earlier}) {
    for (const auto& [name, value] : *entries) {
      const std::string before = value_in(earlier, name), here = value_in(now, name);
      if (before != here) return fmt::format("{}: was {}, now {}", name, before, here);
    }
  }
  return std::nullopt;
}

}  // namespace

MadeWith made_with(const std::vector<PinholeCamera>& cameras, const BodyModel& body) {
  std::string of_cameras;
  for (const PinholeCamera& camera : cameras) of_cameras += bytes_of(camera);
  return {{"the cameras (checksum)", fmt::format("{:08x}", checksum(of_cameras))},
          {"the body (checksum)", fmt::format("{:08x}", checksum(bytes_of(body)))}};
}

uint32_t image_checksum(const Frame& frame) {
  constexpr int kEvery = 16;  // rows
  std::string rows;
  for (const ByteImage& image : frame.images) {
    rows += to_bytes(image.width(), image.height());
    for (int y = 0; y < image.height(); y += kEvery) rows.append(image.row(y).begin(), image.row(y).end());
  }
  return checksum(rows);
}

Result<void> write_checkpoint(const std::filesystem::path& folder, const MadeWith& made_with,
                              const Checkpoint& checkpoint) {
  return write_checked_file(folder / kCheckpointFile, kCheckpoint, to_bytes(made_with, to_bytes(checkpoint)));
}

Result<std::optional<Checkpoint>> read_checkpoint(const std::filesystem::path& folder, const MadeWith& made_with) {
  const std::filesystem::path path = folder / kCheckpointFile;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::optional<Checkpoint>();
  const Result<std::string> bytes = read_checked_file(path, kCheckpoint);
  if (!bytes) return bytes.failure();
  MadeWith earlier;
  std::string state;
  if (!from_bytes(*bytes, earlier, state)) return error("{}: malformed", path.string());
  if (const std::optional<std::string> other = difference(earlier, made_with)) {
    return error("{} can only be resumed as it was started; {}", folder.string(), *other);
  }
  std::optional<Checkpoint> checkpoint(std::in_place);
  if (!from_bytes(state, *checkpoint)) return error("{}: malformed", path.string());
  return checkpoint;
}

}  // namespace silpose
