#include "silpose/geometry/calibration_file.h"

#include <toml++/toml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"

namespace silpose {
namespace {

constexpr int kLargestImage = 16384;     // pixels a side
constexpr double kLargestTurn = 1e6;     // radians; beyond it, no digits are left for the direction [guess]
constexpr double kPixelCentre = 0.5;     // the library's pixels less OpenCV's
constexpr double kFarCentre = 100;       // a camera further from the origin than this is probably in millimetres
constexpr double kClearlyUpright = 0.7;  // cosine between the cameras' mean up direction and the axis assumed to be up

// One camera as the file has it: the file's own world and unit.
struct FileCamera {
  PinholeCamera camera;
  unsigned line = 0;
};

// A finite number. TOML has integers and floats; both are numbers here.
std::optional<double> number(const toml::node& node) {
  if (!node.is_number()) return std::nullopt;
  const std::optional<double> value = node.value<double>();
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

// `where` is "FILE: camera 'NAME': KEY" in all that follows.
Result<std::vector<double>> numbers(const toml::node* node, size_t fewest, size_t most, const std::string& where) {
  if (!node) return error("{} is missing", where);
  const toml::array* array = node->as_array();
  if (!array) return error("{} is not a list of numbers", where);
  if (array->size() < fewest || array->size() > most) {
    return error("{} has {} entries, not {}", where, array->size(),
                 fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most));
  }
  std::vector<double> values;
  for (const toml::node& entry : *array) {
    const std::optional<double> value = number(entry);
    if (!value) return error("{} holds something that is not a finite number", where);
    values.push_back(*value);
  }
  return values;
}

Result<void> read_matrix(const toml::node* node, const std::string& where, PinholeCamera& camera) {
  if (!node) return error("{} is missing", where);
  const toml::array* rows = node->as_array();
  if (!rows || rows->size() != 3) return error("{} is not a list of 3 rows", where);
  Eigen::Matrix3d matrix;
  for (int r = 0; r < 3; ++r) {
    auto row = numbers(rows->get(static_cast<size_t>(r)), 3, 3, fmt::format("{} row {}", where, r + 1));
    if (!row) return row.failure();
    matrix.row(r) = Eigen::Map<const Eigen::RowVector3d>(row->data());
  }
  if (!(matrix(0, 0) > 0 && matrix(1, 1) > 0)) return error("{}: the focal length is not positive", where);
  if (matrix(0, 1) != 0) return error("{}: a skew is not supported", where);
  if (matrix(1, 0) != 0 || matrix.row(2) != Eigen::RowVector3d(0, 0, 1)) {
    return error("{} is not a camera matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]", where);
  }
  camera.fx = matrix(0, 0);
  camera.fy = matrix(1, 1);
  camera.cx = matrix(0, 2) + kPixelCentre;
  camera.cy = matrix(1, 2) + kPixelCentre;
  return {};
}

Result<FileCamera> read_camera(const std::string& file, std::string_view key, const toml::table& table) {
  FileCamera result;
  PinholeCamera& camera = result.camera;
  result.line = table.source().begin.line;
  camera.name = key;
  if (const toml::node* name = table.get("name")) {
    const auto text = name->value<std::string>();
    if (!name->is_string() || text->empty()) return error("{}: camera '{}': name is not a text", file, key);
    camera.name = *text;
  }
  if (camera.name.find('/') != std::string::npos) {  // files are named after cameras
    return error("{}: camera '{}': a name has no /", file, camera.name);
  }
  const auto where = [&](std::string_view field) {
    return fmt::format("{}: camera '{}': {}", file, camera.name, field);
  };

  if (const toml::node* fisheye = table.get("fisheye")) {
    if (!fisheye->is_boolean()) return error("{} is not true or false", where("fisheye"));
    if (*fisheye->value<bool>()) return error("{} cameras are not supported", where("fisheye"));
  }
  auto size = numbers(table.get("size"), 2, 2, where("size"));
  if (!size) return size.failure();
  for (const double pixels : *size) {
    if (!(pixels >= 1 && pixels <= kLargestImage && pixels == std::floor(pixels))) {
      return error("{} is not [width, height] in whole pixels, 1 to {}", where("size"), kLargestImage);
    }
  }
  camera.width = static_cast<int>((*size)[0]);
  camera.height = static_cast<int>((*size)[1]);
  if (auto matrix = read_matrix(table.get("matrix"), where("matrix"), camera); !matrix) return matrix.failure();
  auto distortion = numbers(table.get("distortions"), 4, 5, where("distortions"));
  if (!distortion) return distortion.failure();
  std::copy(distortion->begin(), distortion->end(), camera.distortion.begin());
  auto rotation = numbers(table.get("rotation"), 3, 3, where("rotation"));
  if (!rotation) return rotation.failure();
  const Eigen::Vector3d rodrigues = Eigen::Map<const Eigen::Vector3d>(rotation->data());
  if (!(rodrigues.norm() <= kLargestTurn)) return error("{} is not a rotation vector in radians", where("rotation"));
  if (rodrigues.norm() > 0) {
    camera.cam_from_world.rotation = Eigen::AngleAxisd(rodrigues.norm(), rodrigues.normalized()).toRotationMatrix();
  }
  auto translation = numbers(table.get("translation"), 3, 3, where("translation"));
  if (!translation) return translation.failure();
  camera.cam_from_world.translation = Eigen::Map<const Eigen::Vector3d>(translation->data());
  return result;
}

// Other tables (metadata, a capture volume, a board) are next to the cameras; none has these keys.
bool is_camera(const toml::table& table) {
  return table.contains("matrix") || table.contains("distortions") ||
         (table.contains("size") && (table.contains("rotation") || table.contains("translation")));
}

// What [metadata] says of up axis and unit.
struct Metadata {
  std::optional<UpAxis> up;
  std::optional<double> metres_per_unit;
};

Result<Metadata> read_metadata(const std::string& file, const toml::table& root) {
  Metadata metadata;
  const toml::table* table = root["metadata"].as_table();
  if (!table) return metadata;
  if (const toml::node* up = table->get("up")) {
    const auto text = up->value<std::string>();
    if (text == "y" || text == "Y") {
      metadata.up = UpAxis::kY;
    } else if (text == "z" || text == "Z") {
      metadata.up = UpAxis::kZ;
    } else {
      return error("{}: [metadata] up is neither \"y\" nor \"z\"", file);
    }
  }
  if (const toml::node* unit = table->get("unit")) {
    const auto text = unit->value<std::string>();
    if (text == "m") {
      metadata.metres_per_unit = 1;
    } else if (text == "mm") {
      metadata.metres_per_unit = 0.001;
    } else {
      return error("{}: [metadata] unit is neither \"m\" nor \"mm\"", file);
    }
  }
  return metadata;
}

// Mean of the cameras' up directions in the file's world; zero where they cancel out.
Eigen::Vector3d mean_up(const std::vector<FileCamera>& cameras) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const FileCamera& entry : cameras) sum -= entry.camera.cam_from_world.rotation.row(1).transpose();
  return sum / static_cast<double>(cameras.size());
}

// Determines the up axis where the file does not specify it. The axis is the one nearest to the line of the mean up
// direction; a world whose axis points down, as one fixed to its first camera does, is turned over.
void assume_up(const std::string& file, const std::vector<FileCamera>& cameras, Calibration& calibration) {
  const Eigen::Vector3d up = mean_up(cameras);
  const bool is_z = std::abs(up.z()) > std::abs(up.y());
  const double along = is_z ? up.z() : up.y();
  calibration.up = is_z ? UpAxis::kZ : UpAxis::kY;
  calibration.up_assumed = true;
  calibration.up_reversed = along < 0;
  calibration.warnings.push_back(
      fmt::format("{}: does not say which axis is up; {}{} assumed from the cameras' mean up direction", file,
                  calibration.up_reversed ? "-" : "", is_z ? "z" : "y"));
  if (std::abs(along) < kClearlyUpright) {
    calibration.warnings.push_back(
        fmt::format("{}: the cameras' mean up direction ({:.2f}, {:.2f}, {:.2f}) is not clear; say which axis is up",
                    file, up.x(), up.y(), up.z()));
  }
}

// Y-up world from the file's world.
Eigen::Matrix3d world_from_file(const Calibration& calibration) {
  const double sign = calibration.up_reversed ? -1 : 1;
  Eigen::Matrix3d rotation;
  if (calibration.up == UpAxis::kZ) {
    rotation << 1, 0, 0, 0, 0, sign, 0, -sign, 0;
  } else {
    rotation << 1, 0, 0, 0, sign, 0, 0, 0, sign;
  }
  return rotation;
}

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

// Shortest text that reads back the same, always a float: older TOML readers refuse lists that mix in integers.
std::string float_text(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

template <class Values>
std::string list_text(const Values& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + float_text(value);
  return text + "]";
}

}  // namespace

Result<Calibration> load_calibration(const std::filesystem::path& path, const CalibrationOptions& options) {
  const std::string file = path.string();
  if (options.metres_per_unit) {
    check(*options.metres_per_unit > 0 && std::isfinite(*options.metres_per_unit), "metres_per_unit {}",
          *options.metres_per_unit);
  }
  const auto text = read_text_file(path);
  if (!text) return text.failure();
  toml::table root;
  try {
    root = toml::parse(std::string_view(*text));
  } catch (const toml::parse_error& broken) {
    return error("{}: line {}: not TOML: {}", file, broken.source().begin.line, broken.description());
  }

  const auto metadata = read_metadata(file, root);
  if (!metadata) return metadata.failure();
  std::vector<FileCamera> cameras;
  for (const auto& [key, node] : root) {
    const toml::table* table = node.as_table();
    if (!table || key.str() == "metadata" || !is_camera(*table)) continue;
    auto camera = read_camera(file, key.str(), *table);
    if (!camera) return camera.failure();
    cameras.push_back(std::move(*camera));
  }
  if (cameras.empty()) return error("{}: holds no camera", file);
  // The parser keeps tables by name; cameras are numbered in the order of the file.
  std::stable_sort(cameras.begin(), cameras.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
  for (size_t i = 0; i < cameras.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (cameras[i].camera.name == cameras[j].camera.name) {
        return error("{}: two cameras are named '{}'", file, cameras[i].camera.name);
      }
    }
  }

  Calibration calibration;
  if (const auto up = options.up ? options.up : metadata->up) {
    calibration.up = *up;
  } else {
    assume_up(file, cameras, calibration);
  }
  const auto unit = options.metres_per_unit ? options.metres_per_unit : metadata->metres_per_unit;
  const Eigen::Matrix3d file_from_world = world_from_file(calibration).transpose();
  for (FileCamera& entry : cameras) {
    Rigid3& pose = entry.camera.cam_from_world;
    pose.rotation = pose.rotation * file_from_world;
    pose.translation *= unit.value_or(1);
    calibration.cameras.push_back(std::move(entry.camera));
  }
  if (!unit && calibration.cameras[0].centre_in_world().norm() > kFarCentre) {
    calibration.warnings.push_back(
        fmt::format("{}: does not say its unit; metres assumed, but camera '{}' would be {:.0f} m from the origin",
                    file, calibration.cameras[0].name, calibration.cameras[0].centre_in_world().norm()));
  }
  return calibration;
}

Result<std::vector<PinholeCamera>> load_cameras(const std::filesystem::path& path) {
  auto calibration = load_calibration(path);
  if (!calibration) return calibration.failure();
  return std::move(calibration->cameras);
}

Result<void> write_cameras(const std::filesystem::path& path, const std::vector<PinholeCamera>& cameras) {
  std::string text;
  for (const PinholeCamera& camera : cameras) {
    const Eigen::AngleAxisd turn(camera.cam_from_world.rotation);
    const Eigen::Vector3d rotation = turn.angle() * turn.axis(), translation = camera.cam_from_world.translation;
    const std::array<double, 2> size = {static_cast<double>(camera.width), static_cast<double>(camera.height)};
    text += fmt::format("[{}]\nname = {}\nsize = {}\n", toml_string(camera.name), toml_string(camera.name),
                        list_text(size));
    text +=
        fmt::format("matrix = [[{}, 0.0, {}], [0.0, {}, {}], [0.0, 0.0, 1.0]]\n", float_text(camera.fx),
                    float_text(camera.cx - kPixelCentre), float_text(camera.fy), float_text(camera.cy - kPixelCentre));
    // Four coefficients where the fifth is zero: some readers take no more.
    const std::vector<double> distortion(camera.distortion.begin(),
                                         camera.distortion.end() - (camera.distortion[4] == 0 ? 1 : 0));
    text += fmt::format("distortions = {}\nrotation = {}\ntranslation = {}\nfisheye = false\n\n", list_text(distortion),
                        list_text(rotation), list_text(translation));
  }
  text += "[metadata]\nup = \"y\"\nunit = \"m\"\n";
  return write_text_file(path, text);
}

}  // namespace silpose
