#include <algorithm>
#include <charconv>
#include <system_error>

#include "silpose/evaluate/evaluation.h"
#include "silpose/geometry/calibration_file.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

// The number of "000123.png"; nothing for other files.
std::optional<int64_t> frame_of(const fs::path& path) {
  if (path.extension() != ".png") return std::nullopt;
  const std::string stem = path.stem().string();
  int64_t frame = 0;
  const auto [end, code] = std::from_chars(stem.data(), stem.data() + stem.size(), frame);
  if (code != std::errc() || end != stem.data() + stem.size() || frame < 0) return std::nullopt;
  return frame;
}

std::map<int64_t, fs::path> list_masks(const fs::path& directory) {
  std::map<int64_t, fs::path> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(directory, code)) {
    if (const auto frame = frame_of(entry.path())) files.emplace(*frame, entry.path());
  }
  return files;
}

}  // namespace

Result<Recorded> read_recorded(const fs::path& directory, const BodyModel& body) {
  if (!fs::is_directory(directory)) return error("{}: no such directory", directory.string());
  Recorded recorded;
  if (const fs::path path = directory / "poses.csv"; fs::exists(path)) {
    auto poses = read_poses(path, body.skeleton);
    if (!poses) return poses.failure();
    recorded.poses = std::move(*poses);
  }
  if (const fs::path path = directory / "joints.csv"; fs::exists(path)) {
    auto joints = read_joints(path);
    if (!joints) return joints.failure();
    const std::vector<std::string> known = landmark_names(body);
    for (JointTable::Row& row : joints->rows) {
      if (const auto own = body.profile.landmark_called(row.joint, "openpose"); !own.empty()) row.joint = own;
      if (std::find(known.begin(), known.end(), row.joint) == known.end()) {
        return error("{}: frame {}: unknown joint '{}'", path.string(), row.frame, row.joint);
      }
    }
    recorded.joints = std::move(*joints);
  }
  if (const fs::path path = directory / "camera.toml"; fs::exists(path)) {
    auto cameras = load_cameras(path);
    if (!cameras) return cameras.failure();
    recorded.cameras = std::move(*cameras);
  }
  recorded.mask_files = list_masks(directory / "masks");
  if (recorded.mask_files.empty() && !recorded.cameras.empty()) {
    recorded.mask_files = list_masks(directory / ("masks_" + recorded.cameras[0].name));
  }
  if (!recorded.poses && !recorded.joints && recorded.mask_files.empty()) {
    return error("{}: holds neither poses.csv nor joints.csv nor masks", directory.string());
  }
  return recorded;
}

}  // namespace silpose
