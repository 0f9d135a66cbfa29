#include "silpose/exchange/humanoid3d.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using nlohmann::json;

constexpr size_t kNumValues = 44;       // of a frame
constexpr double kSameDuration = 0.01;  // of the mean: durations are written with six digits or more
constexpr double kLargest = 1e6, kShortest = 1e-5, kLongest = 1e3;  // metres or radians; seconds
constexpr size_t kMostFrames = 1'000'000;
constexpr double kSmallestNorm = 0.1;  // of a quaternion: published files have lengths from 0.58 to 1.12

enum class Turns { kNot, kByQuaternion, kByAngle };

// In the order of the file. Offsets in metres; angles turn about z, so that a bent knee's is negative.
struct JointRow {
  const char* name;
  int parent_idx;
  Turns turns;
  double x, y, z;
};
constexpr std::array<JointRow, 18> kJoints{{
    {"root", -1, Turns::kByQuaternion, 0, 0, 0},
    {"chest", 0, Turns::kByQuaternion, 0, 0.236151, 0},
    {"neck", 1, Turns::kByQuaternion, 0, 0.223894, 0},
    {"head", 2, Turns::kNot, 0, 0.175, 0},  // the middle of its sphere
    {"right_hip", 0, Turns::kByQuaternion, 0, 0, 0.084887},
    {"right_knee", 4, Turns::kByAngle, 0, -0.421546, 0},
    {"right_ankle", 5, Turns::kByQuaternion, 0, -0.409870, 0},
    {"right_toe", 6, Turns::kNot, 0.1335, -0.05, 0},  // front edge of the sole
    {"right_shoulder", 1, Turns::kByQuaternion, -0.02405, 0.2435, 0.18311},
    {"right_elbow", 8, Turns::kByAngle, 0, -0.274788, 0},
    {"right_wrist", 9, Turns::kNot, 0, -0.258947, 0},
    {"left_hip", 0, Turns::kByQuaternion, 0, 0, -0.084887},
    {"left_knee", 11, Turns::kByAngle, 0, -0.421546, 0},
    {"left_ankle", 12, Turns::kByQuaternion, 0, -0.409870, 0},
    {"left_toe", 13, Turns::kNot, 0.1335, -0.05, 0},
    {"left_shoulder", 1, Turns::kByQuaternion, -0.02405, 0.2435, -0.18311},
    {"left_elbow", 15, Turns::kByAngle, 0, -0.274788, 0},
    {"left_wrist", 16, Turns::kNot, 0, -0.258947, 0},
}};

struct Frame {
  double duration_s = 0;
  Vector3d root = Vector3d::Zero();
  std::array<Quaterniond, kJoints.size()> rotations;
};

Result<Frame> parse_frame(const json& values, const std::string& where) {
  if (!values.is_array() || values.size() != kNumValues) {
    return error("{}: {} values, not {}", where, values.is_array() ? values.size() : 0, kNumValues);
  }
  std::array<double, kNumValues> numbers{};
  for (size_t i = 0; i < kNumValues; ++i) {
    numbers[i] = values[i].is_number() ? values[i].get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(std::abs(numbers[i]) <= kLargest)) return error("{}: value {} is not a usable number", where, i + 1);
  }
  Frame frame;
  frame.duration_s = numbers[0];
  frame.root = Vector3d(numbers[1], numbers[2], numbers[3]);
  size_t at = 4;
  for (size_t j = 0; j < kJoints.size(); ++j) {
    frame.rotations[j] = Quaterniond::Identity();
    if (kJoints[j].turns == Turns::kByAngle) {
      frame.rotations[j] = Eigen::AngleAxisd(numbers[at++], Vector3d::UnitZ());
    } else if (kJoints[j].turns == Turns::kByQuaternion) {
      const Quaterniond q(numbers[at], numbers[at + 1], numbers[at + 2], numbers[at + 3]);
      if (!(q.norm() > kSmallestNorm && q.norm() < 1 / kSmallestNorm)) {
        return error("{}: {}: a quaternion of length {:.3g}", where, kJoints[j].name, q.norm());
      }
      frame.rotations[j] = q.normalized();
      at += 4;
    }
  }
  return frame;
}

void append(const Frame& frame, Clip& clip) {
  for (size_t j = 0; j < kJoints.size(); ++j) {
    clip.rotations.push_back(frame.rotations[j]);
    clip.translations.push_back(j == 0 ? frame.root : clip.joints[j].offset);
  }
}

Frame interpolate(const Frame& a, const Frame& b, double fraction) {
  Frame frame;
  frame.root = a.root + fraction * (b.root - a.root);
  for (size_t j = 0; j < kJoints.size(); ++j) frame.rotations[j] = a.rotations[j].slerp(fraction, b.rotations[j]);
  return frame;
}

// The frames as they are when they last equally long (the last one's duration says nothing), otherwise at the shortest.
Result<void> fill(const std::vector<Frame>& frames, Clip& clip) {
  double total = 0, shortest = kLongest, longest = 0;
  for (size_t t = 0; t + 1 < frames.size(); ++t) {
    total += frames[t].duration_s;
    shortest = std::min(shortest, frames[t].duration_s);
    longest = std::max(longest, frames[t].duration_s);
  }
  if (frames.size() > 1) {
    const double mean = total / static_cast<double>(frames.size() - 1);
    clip.fps = 1 / (longest - shortest <= kSameDuration * mean ? mean : shortest);
    if (longest - shortest > kSameDuration * mean) {
      const double wanted = std::floor(total * clip.fps + 1e-6) + 1;
      if (wanted > kMostFrames) return error("{}: frames from {} to {} s long", clip.name, shortest, longest);
      size_t before = 0;
      double start = 0;  // of frame `before`, seconds
      for (size_t i = 0; i < static_cast<size_t>(wanted); ++i) {
        const double time = static_cast<double>(i) / clip.fps;
        while (before + 2 < frames.size() && time >= start + frames[before].duration_s) {
          start += frames[before++].duration_s;
        }
        const double fraction = std::min((time - start) / frames[before].duration_s, 1.0);
        append(interpolate(frames[before], frames[before + 1], fraction), clip);
      }
      return {};
    }
  }
  for (const Frame& frame : frames) append(frame, clip);
  return {};
}

}  // namespace

Result<Clip> read_humanoid3d(const std::filesystem::path& path) {
  const Result<std::string> text = read_text_file(path);
  if (!text) return text.failure();
  const json file = json::parse(*text, nullptr, false);
  if (file.is_discarded()) return error("{}: not JSON", path.string());
  if (!file.is_object() || !file.contains("Frames") || !file["Frames"].is_array()) {
    return error("{}: no \"Frames\": not a humanoid3d motion", path.string());
  }
  const json& rows = file["Frames"];
  if (rows.empty()) return error("{}: no frame", path.string());
  if (rows.size() > kMostFrames) return error("{}: {} frames are too many", path.string(), rows.size());

  Clip clip;
  clip.name = path.filename().string();
  for (const JointRow& row : kJoints) {
    const bool is_end = row.turns == Turns::kNot;
    clip.joints.push_back({row.name, row.parent_idx, Vector3d(row.x, row.y, row.z), is_end});
  }
  std::vector<Frame> frames;
  for (const json& row : rows) {
    const std::string where = fmt::format("{}: frame {}", path.string(), frames.size());
    Result<Frame> frame = parse_frame(row, where);
    if (!frame) return frame.failure();
    const bool is_last = frames.size() + 1 == rows.size();
    if (!is_last && !(frame->duration_s >= kShortest && frame->duration_s <= kLongest)) {
      return error("{}: lasts {} s", where, frame->duration_s);
    }
    frames.push_back(std::move(*frame));
  }
  if (const Result<void> filled = fill(frames, clip); !filled) return filled.failure();
  return clip;
}

}  // namespace silpose
