#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "silpose/base/text_file.h"
#include "silpose/exchange/bvh.h"

namespace silpose {
namespace {

constexpr int kMaxChannels = 6;                               // of one joint
constexpr double kLargest = 1e9;                              // of any number in the file
constexpr double kShortestFrame = 1e-5, kLongestFrame = 1e3;  // seconds
// Far more than any capture has; they keep a broken file from filling the memory. [guess]
constexpr int64_t kMaxJoints = 10'000;
constexpr size_t kMaxTransforms = 100'000'000;  // joints times frames: an hour at 120 fps has 43 million of 100 joints

enum class Channel { kXPosition, kYPosition, kZPosition, kXRotation, kYRotation, kZRotation };

std::string to_lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// Words separated by blanks, line ends and colons; braces stand alone.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);
  }

  // The next word, empty at the end.
  std::string_view next() {
    skip();
    if (at_ == text_.size()) return {};
    size_t end = at_ + 1;
    if (!is_brace(text_[at_])) {
      while (end < text_.size() && !is_separator(text_[end]) && !is_brace(text_[end])) ++end;
    }
    return text_.substr(std::exchange(at_, end), end - at_);
  }

  std::string_view peek() {
    const auto [at, line] = std::pair(at_, line_);
    const std::string_view word = next();
    at_ = at, line_ = line;
    return word;
  }

  // What is left of the line up to a brace, without blanks around it: a name, which may hold blanks and colons.
  std::string_view rest_of_line() {
    size_t end = at_;
    while (end < text_.size() && text_[end] != '\n' && !is_brace(text_[end])) ++end;
    std::string_view rest = text_.substr(at_, end - at_);
    at_ = end;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    return rest;
  }

  // True when nothing but blanks is left before the line end.
  [[nodiscard]] bool at_line_end() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    return at_ == text_.size() || text_[at_] == '\n';
  }

  // Of the word read last, counted from 1.
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] size_t bytes_left() const { return text_.size() - at_; }

 private:
  static bool is_brace(char c) { return c == '{' || c == '}'; }
  static bool is_separator(char c) { return is_blank(c) || c == '\n' || c == ':'; }

  void skip() {
    for (; at_ < text_.size() && is_separator(text_[at_]); ++at_) line_ += text_[at_] == '\n';
  }

  std::string_view text_;
  size_t at_ = 0;
  int line_ = 1;
};

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_whole = code == std::errc() && end == word.data() + word.size();
  if (!is_whole || !std::isfinite(value) || std::abs(value) > kLargest) return std::nullopt;
  return value;
}

std::optional<Channel> to_channel(std::string_view word) {
  static constexpr std::array<std::string_view, 6> kNames = {"xposition", "yposition", "zposition",
                                                             "xrotation", "yrotation", "zrotation"};
  const auto found = std::find(kNames.begin(), kNames.end(), to_lower(word));
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Channel>(found - kNames.begin());
}

// Frame times are rounded in the file: 0.0083333 means 120 per second. Rates that round to the same text are whole.
double fps_from_frame_time(std::string_view word, double frame_time_s) {
  const double fps = 1 / frame_time_s, whole = std::round(fps);
  const size_t dot = word.find('.');
  const size_t decimals = dot == std::string_view::npos ? 0 : word.size() - dot - 1;
  const double last_digit = std::pow(10.0, -static_cast<double>(decimals));
  const bool same = whole >= 1 && word.find_first_of("eE") == std::string_view::npos && decimals >= 4 &&
                    std::abs(frame_time_s - 1 / whole) <= last_digit;
  return same ? whole : fps;
}

class Reader {
 public:
  Reader(std::string file, std::string_view text) : file_(std::move(file)), lexer_(text) {}

  Result<Clip> read() {
    if (auto done = read_hierarchy(); !done) return done.failure();
    if (auto done = read_motion(); !done) return done.failure();
    return std::move(clip_);
  }

 private:
  template <class... Args>
  tl::unexpected<Error> wrong(fmt::format_string<Args...> format, Args&&... args) const {
    return error("{}: line {}: {}", file_, lexer_.line(), fmt::format(format, std::forward<Args>(args)...));
  }

  // A word as a message shows it.
  static std::string shown(std::string_view word) {
    return word.empty() ? "the end of the file" : fmt::format("'{}'", word.substr(0, 40));
  }

  Result<void> read_hierarchy() {
    if (const auto word = lexer_.next(); to_lower(word) != "hierarchy") {
      return wrong("not BVH: {} where HIERARCHY should be", shown(word));
    }
    std::vector<int> open;  // joints whose brace is open
    while (true) {
      const std::string_view word = lexer_.next();
      const std::string key = to_lower(word);
      if (key == "}" && !open.empty()) {
        open.pop_back();
      } else if (key == "motion" && open.empty() && !clip_.joints.empty()) {
        return {};
      } else if ((key == "root" && open.empty()) || ((key == "joint" || key == "end") && !open.empty())) {
        if (!open.empty() && clip_.joints[open.back()].is_end) return wrong("a joint inside an end site");
        if (std::ssize(clip_.joints) >= kMaxJoints) return wrong("more than {} joints", kMaxJoints);
        auto joint = read_joint(key == "end", open.empty() ? -1 : open.back());
        if (!joint) return joint.failure();
        open.push_back(*joint);
      } else if (word.empty() && !open.empty()) {
        return wrong("ends inside joint '{}'", clip_.joints[open.back()].name);
      } else {
        return wrong("{} where {} should be", shown(word),
                     !open.empty()          ? "JOINT, End Site or }"
                     : clip_.joints.empty() ? "ROOT"
                                            : "MOTION");
      }
    }
  }

  // From after the keyword to the end of CHANNELS. Returns the joint's index.
  Result<int> read_joint(bool is_end, int parent) {
    Clip::Joint joint{.name = std::string(lexer_.rest_of_line()), .parent_idx = parent, .is_end = is_end};
    if (is_end) joint.name = clip_.joints[parent].name + "_end";
    if (joint.name.empty()) return wrong("a joint without a name");
    if (const auto word = lexer_.next(); word != "{") return wrong("{} where {{ should be", shown(word));
    if (const auto word = lexer_.next(); to_lower(word) != "offset") {
      return wrong("{} where the OFFSET of '{}' should be", shown(word), joint.name);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto word = lexer_.next();
      const auto value = to_number(word);
      if (!value) return wrong("OFFSET of '{}': {} is not a number up to 1e9", joint.name, shown(word));
      joint.offset[axis] = *value;
    }
    const int index = static_cast<int>(clip_.joints.size());
    channels_.emplace_back();
    if (to_lower(lexer_.peek()) == "channels") {
      lexer_.next();
      const auto word = lexer_.next();
      const auto count = to_number(word);
      if (!count || *count < 0 || *count > kMaxChannels || *count != std::floor(*count)) {
        return wrong("CHANNELS of '{}': {} is not a number from 0 to {}", joint.name, shown(word), kMaxChannels);
      }
      for (int k = 0; k < static_cast<int>(*count); ++k) {
        const auto name = lexer_.next();
        const auto channel = to_channel(name);
        if (!channel) return wrong("CHANNELS of '{}': unknown channel {}", joint.name, shown(name));
        channels_.back().push_back(*channel);
      }
      num_channels_ += channels_.back().size();
    }
    clip_.joints.push_back(std::move(joint));
    return index;
  }

  Result<void> read_motion() {
    clip_.name = file_;
    if (const auto word = lexer_.next(); to_lower(word) != "frames") {
      return wrong("{} where 'Frames:' should be", shown(word));
    }
    const auto count_word = lexer_.next();
    const auto count = to_number(count_word);
    if (!count || *count < 0 || *count != std::floor(*count) || *count > 1e9) {
      return wrong("Frames: {} is not a number of frames", shown(count_word));
    }
    if (*count == 0) return wrong("holds no frame");
    for (const char* expected : {"frame", "time"}) {
      if (const auto word = lexer_.next(); to_lower(word) != expected) {
        return wrong("{} where 'Frame Time:' should be", shown(word));
      }
    }
    const auto time_word = lexer_.next();
    const auto frame_time_s = to_number(time_word);
    if (!frame_time_s || *frame_time_s <= 0) {
      return wrong("Frame Time: {} is not a positive number of seconds", shown(time_word));
    }
    if (*frame_time_s < kShortestFrame || *frame_time_s > kLongestFrame) {
      return wrong("Frame Time: {} is not within {} to {} seconds", shown(time_word), kShortestFrame, kLongestFrame);
    }
    if (num_channels_ == 0) return wrong("no joint has channels");
    clip_.fps = fps_from_frame_time(time_word, *frame_time_s);
    return read_frames(static_cast<size_t>(*count));
  }

  Result<void> read_frames(size_t num_frames) {
    const size_t J = clip_.joints.size();
    // What the file can hold at two bytes per value, however many frames it claims.
    const size_t expected = std::min(num_frames, lexer_.bytes_left() / (2 * num_channels_) + 1) * J;
    if (expected > kMaxTransforms) return wrong("more than {} joints times frames", kMaxTransforms);
    clip_.rotations.reserve(expected);
    clip_.translations.reserve(expected);
    std::vector<double> values(num_channels_);
    for (size_t frame = 0; frame < num_frames; ++frame) {
      for (size_t k = 0; k < num_channels_; ++k) {
        const auto word = lexer_.next();
        if (word.empty()) return wrong("ends in frame {} of {}", frame + 1, num_frames);
        const auto value = to_number(word);
        if (!value) return wrong("frame {}: {} is not a number up to 1e9", frame + 1, shown(word));
        values[k] = *value;
        if (lexer_.at_line_end() != (k + 1 == num_channels_)) {
          return wrong("frame {}: {} than {} values in the line", frame + 1, k + 1 < num_channels_ ? "fewer" : "more",
                       num_channels_);
        }
      }
      append_frame(values);
    }
    if (const auto word = lexer_.next(); !word.empty()) {
      return wrong("{} after the last of {} frames", shown(word), num_frames);
    }
    keep_offsets_of_unused_positions();
    return {};
  }

  void append_frame(const std::vector<double>& values) {
    size_t k = 0;
    for (size_t j = 0; j < clip_.joints.size(); ++j) {
      Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
      Eigen::Vector3d translation = clip_.joints[j].offset;
      for (const Channel channel : channels_[j]) {
        const double value = values[k++];
        const int axis = static_cast<int>(channel) % 3;
        if (channel < Channel::kXRotation) {
          translation[axis] = value;
        } else {
          // Channels in the file's order are rotations from the outermost to the innermost.
          rotation = rotation * Eigen::Quaterniond(Eigen::AngleAxisd(to_radians(value), Eigen::Vector3d::Unit(axis)));
        }
      }
      clip_.rotations.push_back(rotation.normalized());
      clip_.translations.push_back(translation);
    }
  }

  void keep_offsets_of_unused_positions() {
    const size_t J = clip_.joints.size(), T = clip_.num_frames();
    for (size_t j = 0; j < J; ++j) {
      if (clip_.joints[j].parent_idx < 0) continue;
      bool unused = true;
      for (size_t frame = 0; frame < T && unused; ++frame) unused = clip_.translations[frame * J + j].isZero(0);
      for (size_t frame = 0; frame < T && unused; ++frame) clip_.translations[frame * J + j] = clip_.joints[j].offset;
    }
  }

  std::string file_;
  Lexer lexer_;
  Clip clip_;
  std::vector<std::vector<Channel>> channels_;  // [J]
  size_t num_channels_ = 0;                     // over all joints
};

}  // namespace

Result<Clip> read_bvh(const std::filesystem::path& path) {
  const auto text = read_text_file(path);
  if (!text) return text.failure();
  if (text->empty()) return error("{}: is empty", path.string());
  return Reader(path.string(), *text).read();
}

}  // namespace silpose
