#include "silpose/experiment/recorded_clip.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "silpose/base/text_file.h"
#include "silpose/exchange/ply.h"
#include "silpose/geometry/calibration_file.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Result<PinholeCamera> read_json_camera(const fs::path& file) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return text.failure();
  PinholeCamera camera;
  try {
    const Json json = Json::parse(*text);
    camera.width = json.at("width").get<int>();
    camera.height = json.at("height").get<int>();
    const Json &matrix = json.at("K"), &rotation = json.at("R_world_to_cam"), &shift = json.at("t_world_to_cam_m");
    camera.fx = matrix.at(0).at(0).get<double>();
    camera.fy = matrix.at(1).at(1).get<double>();
    camera.cx = matrix.at(0).at(2).get<double>();
    camera.cy = matrix.at(1).at(2).get<double>();
    for (int row = 0; row < 3; ++row) {
      camera.cam_from_world.translation[row] = shift.at(static_cast<size_t>(row)).get<double>();
      for (int column = 0; column < 3; ++column) {
        camera.cam_from_world.rotation(row, column) =
            rotation.at(static_cast<size_t>(row)).at(static_cast<size_t>(column)).get<double>();
      }
    }
    const Json distortion = json.value("dist", Json::array());
    for (size_t k = 0; k < distortion.size(); ++k) camera.distortion.at(k) = distortion.at(k).get<double>();
  } catch (const std::exception& wrong) {  // of the JSON, or of a sixth distortion
    return error("{}: no camera: {}", file.string(), wrong.what());
  }
  const Eigen::Matrix3d& rotation = camera.cam_from_world.rotation;
  const bool is_rotation = (rotation * rotation.transpose()).isIdentity(1e-6) && rotation.determinant() > 0;
  if (!is_rotation || !(camera.fx > 0) || !(camera.fy > 0) || camera.width < 1 || camera.height < 1) {
    return error("{}: no camera: a size or focal length that is not positive, or no rotation", file.string());
  }
  return camera;
}

// The number at the end of a file's name without extension.
std::optional<int64_t> number_of_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  const size_t begin = stem.find_last_not_of("0123456789") + 1;
  int64_t number = 0;
  const auto [end, bad] = std::from_chars(stem.data() + begin, stem.data() + stem.size(), number);
  if (begin == stem.size() || bad != std::errc()) return std::nullopt;
  return number;
}

std::map<int64_t, fs::path> list_meshes(const fs::path& folder) {
  std::map<int64_t, fs::path> files;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const auto number = number_of_name(entry.path());
    if (entry.path().extension() == ".ply" && number) files.emplace(*number - 1, entry.path());
  }
  return files;
}

}  // namespace

Result<std::vector<PinholeCamera>> read_clip_cameras(const RunSettings& settings, const fs::path& data) {
  const fs::path file = data / settings.camera;
  std::vector<PinholeCamera> all, chosen;
  if (file.extension() == ".json") {
    Result<PinholeCamera> camera = read_json_camera(file);
    if (!camera) return camera.failure();
    all.push_back(std::move(*camera));
  } else {
    Result<std::vector<PinholeCamera>> cameras = load_cameras(file);
    if (!cameras) return cameras.failure();
    all = std::move(*cameras);
  }
  for (const std::string& name : settings.camera_names) {
    const auto found = std::ranges::find(all, name, &PinholeCamera::name);
    if (found == all.end()) return error("{}: no camera {}", file.string(), name);
    chosen.push_back(*found);
  }
  if (settings.camera_names.empty()) chosen = std::move(all);
  if (chosen.size() != settings.clip.size()) {
    return error("{}: {} cameras for {} videos; choose with camera_names", file.string(), chosen.size(),
                 settings.clip.size());
  }
  return chosen;
}

Result<ClipTruth> read_clip_truth(const RunSettings& settings, const fs::path& data, const BodyModel& body) {
  const fs::path folder = data / settings.truth;
  ClipTruth truth;
  const std::map<int64_t, fs::path> meshes = list_meshes(folder);
  if (meshes.empty() || fs::exists(folder / "joints.csv")) {
    Result<Recorded> recorded = read_recorded(folder, body);
    if (!recorded) return recorded.failure();
    if (!recorded->joints) return error("{}: no joints.csv", folder.string());
    truth.joints = std::move(*recorded);
    return truth;
  }
  for (const auto& [frame, file] : meshes) {
    Result<std::vector<Eigen::Vector3f>> points = read_ply_vertices(file);
    if (!points) return points.failure();
    if (settings.truth_above) {
      std::erase_if(*points, [&](const Eigen::Vector3f& x) { return !(x.y() > *settings.truth_above); });
    }
    if (points->empty()) return error("{}: no vertex that counts", file.string());
    truth.surfaces.push_back({frame, std::move(*points)});
  }
  return truth;
}

Result<void> check_clip_files(const RunSettings& settings, const fs::path& data) {
  std::error_code failed;
  const auto file = [&](const std::string& path) -> Result<void> {
    if (fs::exists(data / path, failed)) return {};
    return error("{}: no such file", (data / path).string());
  };
  for (const std::string& video : settings.clip) {
    if (Result<void> there = file(video); !there) return there;
  }
  if (Result<void> there = file(settings.camera); !there) return there;
  if (Result<void> there = file(settings.truth); !there) return there;
  if (settings.segmenter != "background") return {};
  for (const std::string& background : settings.background) {
    if (background == "auto") continue;
    if (Result<void> there = file(background); !there) return there;
  }
  return {};
}

}  // namespace silpose
