#include "silpose/image/frame_source.h"

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <utility>
#include <vector>

#include "silpose/image/image_file.h"

extern "C" {
#include <libavutil/log.h>
}

namespace silpose {
namespace {

namespace fs = std::filesystem;

// A video file or a live camera.
class CaptureSource : public FrameSource {
 public:
  CaptureSource(std::string name, std::optional<int> device) : name_(std::move(name)), device_(device) {}

  Result<void> rewind() override {
    if (device_ && capture_.isOpened()) return error("{}: a live camera cannot go back to its first frame", name_);
    // Opened anew: seeking is not exact in every container.
    const bool opened = device_ ? capture_.open(*device_) : capture_.open(fs::absolute(name_).string(), cv::CAP_FFMPEG);
    if (!opened) return device_ ? error("{}: no such camera", name_) : error("{}: not a video", name_);
    return {};
  }

  [[nodiscard]] double fps() const override {
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    return rate > 0 && rate <= 1000 ? rate : 0;
  }
  [[nodiscard]] int64_t num_frames_hint() const override {
    const double count = device_ ? 0 : capture_.get(cv::CAP_PROP_FRAME_COUNT);
    return count > 0 && count < 1e12 ? static_cast<int64_t>(count) : 0;
  }
  [[nodiscard]] bool is_live() const override { return device_.has_value(); }

  Result<std::optional<ByteImage>> next() override {
    try {
      if (!capture_.grab()) return std::optional<ByteImage>();
      // Decoded straight into the picture where it is as large as the last one.
      ByteImage image(width_, height_, 3);
      cv::Mat view(height_, width_, CV_8UC3, image.pixels().data());
      const uint8_t* own = view.data;
      if (!capture_.retrieve(view) || view.empty()) return std::optional<ByteImage>();
      if (view.data != own || own == nullptr) {
        if (view.type() != CV_8UC3) return error("{}: frames are not 8-bit colour", name_);
        width_ = view.cols;
        height_ = view.rows;
        image = ByteImage(width_, height_, 3);
        view.copyTo(cv::Mat(height_, width_, CV_8UC3, image.pixels().data()));
      }
      return std::optional<ByteImage>(std::move(image));
    } catch (const cv::Exception& exception) {
      return error("{}: cannot be decoded ({})", name_, exception.err);
    }
  }

 private:
  std::string name_;
  std::optional<int> device_;
  mutable cv::VideoCapture capture_;
  int width_ = 0, height_ = 0;
};

struct Pictures {
  std::vector<fs::path> paths;
  std::vector<int64_t> numbers = {};  // one a path, growing; or none
};

class PictureSource : public FrameSource {
 public:
  explicit PictureSource(Pictures pictures)
      : paths_(std::move(pictures.paths)), numbers_(std::move(pictures.numbers)) {}

  [[nodiscard]] std::span<const int64_t> numbers() const override { return numbers_; }
  [[nodiscard]] int64_t num_frames_hint() const override { return static_cast<int64_t>(paths_.size()); }
  Result<std::optional<ByteImage>> next() override {
    if (next_ == paths_.size()) return std::optional<ByteImage>();
    Result<ByteImage> image = read_colour_image(paths_[next_++]);
    if (!image) return image.failure();
    return std::optional<ByteImage>(std::move(*image));
  }
  Result<void> rewind() override {
    next_ = 0;
    return {};
  }

 private:
  std::vector<fs::path> paths_;
  std::vector<int64_t> numbers_;
  size_t next_ = 0;
};

bool is_picture_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::string kPictures[] = {".png",  ".jpg", ".jpeg", ".bmp", ".tif", ".tiff",
                                          ".webp", ".ppm", ".pgm",  ".jp2", ".pbm"};
  return std::find(std::begin(kPictures), std::end(kPictures), extension) != std::end(kPictures);
}

Result<std::vector<fs::path>> files_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && entry->path().filename().string()[0] != '.') paths.push_back(entry->path());
  }
  if (code) return error("{}: cannot be listed ({})", folder.string(), code.message());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// Larger numbers at the end of a name are a date or a clock rather than a count.
constexpr int64_t kLargestNumber = 99'999'999;

// "walk_000030.png" is "walk_" and 30.
std::optional<std::pair<std::string, int64_t>> split_name(const fs::path& path) {
  const std::string stem = path.stem().string();
  const size_t digits = stem.find_last_not_of("0123456789") + 1;
  int64_t number = 0;
  const auto [end, failure] = std::from_chars(stem.data() + digits, stem.data() + stem.size(), number);
  if (digits == stem.size() || failure != std::errc() || number > kLargestNumber) return {};
  return std::pair(stem.substr(0, digits), number);
}

// The numbers of names that are one text and a number each; nothing where any is not.
std::vector<int64_t> numbers_of(const std::vector<fs::path>& paths) {
  std::vector<int64_t> numbers;
  std::string text;
  for (const fs::path& path : paths) {
    const auto name = split_name(path);
    if (!name || (!numbers.empty() && name->first != text)) return {};
    text = name->first;
    numbers.push_back(name->second);
  }
  return numbers;
}

// In the order of their numbers where all have one, of their names otherwise.
Result<Pictures> pictures_in(const fs::path& folder) {
  Result<std::vector<fs::path>> paths = files_in(folder);
  if (!paths) return paths.failure();
  std::erase_if(*paths, [](const fs::path& path) { return !is_picture_name(path); });
  if (paths->empty()) return error("{}: no pictures in this directory", folder.string());
  const auto number = [](const fs::path& path) { return split_name(path)->second; };
  if (!numbers_of(*paths).empty()) std::ranges::stable_sort(*paths, {}, number);
  Pictures pictures{.paths = std::move(*paths)};
  pictures.numbers = numbers_of(pictures.paths);
  const auto twice = std::ranges::adjacent_find(pictures.numbers);
  if (twice != pictures.numbers.end()) {
    const auto at = static_cast<size_t>(twice - pictures.numbers.begin());
    return error("{}: {} and {} have the same number", folder.string(), pictures.paths[at].filename().string(),
                 pictures.paths[at + 1].filename().string());
  }
  return pictures;
}

// The pieces of "name-%06d.png".
struct Pattern {
  std::string before, after;
  size_t min_digits = 1;
};

std::optional<Pattern> parse_pattern(const std::string& name) {
  const size_t percent = name.find('%');
  if (percent == std::string::npos) return {};
  const size_t end = name.find_first_not_of("0123456789", percent + 1);
  if (end == std::string::npos || name[end] != 'd') return {};
  Pattern pattern{.before = name.substr(0, percent), .after = name.substr(end + 1)};
  std::from_chars(name.data() + percent + 1, name.data() + end, pattern.min_digits);
  if (pattern.after.find('%') != std::string::npos || pattern.min_digits > 18) return {};
  return pattern;
}

// In the order of their numbers, which must follow one another.
Result<Pictures> pictures_of_pattern(const fs::path& input, const Pattern& pattern) {
  const fs::path folder = input.has_parent_path() ? input.parent_path() : fs::path(".");
  const Result<std::vector<fs::path>> files = files_in(folder);
  if (!files) return files.failure();
  std::vector<std::pair<int64_t, fs::path>> numbered;
  for (const fs::path& path : *files) {
    const std::string name = path.filename().string();
    if (name.size() <= pattern.before.size() + pattern.after.size() || !name.starts_with(pattern.before) ||
        !name.ends_with(pattern.after)) {
      continue;
    }
    const char *first = name.data() + pattern.before.size(), *last = name.data() + name.size() - pattern.after.size();
    int64_t number = 0;
    const auto [stop, failure] = std::from_chars(first, last, number);
    const size_t digits = static_cast<size_t>(last - first);
    if (failure != std::errc() || stop != last || number < 0 || *first == '-') continue;
    if (digits < pattern.min_digits || (digits > std::max<size_t>(pattern.min_digits, 1) && *first == '0')) continue;
    numbered.emplace_back(number, path);
  }
  if (numbered.empty()) return error("{}: no picture has such a name", input.string());
  std::sort(numbered.begin(), numbered.end());
  Pictures pictures;
  for (const auto& [number, path] : numbered) {
    const int64_t expected = numbered.front().first + std::ssize(pictures.paths);
    if (number != expected) return error("{}: picture number {} is missing", input.string(), expected);
    pictures.paths.push_back(path);
    pictures.numbers.push_back(number);
  }
  if (pictures.numbers.back() > kLargestNumber) pictures.numbers.clear();
  return pictures;
}

// FFmpeg takes some text files for videos (it draws them).
bool is_text(const std::string& start) {
  return std::all_of(start.begin(), start.end(), [](unsigned char c) { return c >= 32 || (c >= 7 && c <= 13); });
}

Result<std::unique_ptr<FrameSource>> open_capture(const std::string& input, std::optional<int> device) {
  auto source = std::make_unique<CaptureSource>(input, device);
  silence_codecs();
  if (const Result<void> opened = source->rewind(); !opened) return opened.failure();
  return std::unique_ptr<FrameSource>(std::move(source));
}

Result<std::unique_ptr<FrameSource>> open_pictures(Result<Pictures> pictures) {
  if (!pictures) return pictures.failure();
  return std::unique_ptr<FrameSource>(std::make_unique<PictureSource>(std::move(*pictures)));
}

}  // namespace

void silence_codecs() {
  static std::once_flag once;
  std::call_once(once, [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    // Not its level: OpenCV sets that anew whenever it opens something.
    av_log_set_callback([](void*, int, const char*, va_list) {});
  });
}

Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& input) {
  static constexpr std::string_view kCamera = "camera:";
  if (input.starts_with(kCamera)) {
    int device = -1;
    const char* end = input.data() + input.size();
    const auto [stop, failure] = std::from_chars(input.data() + kCamera.size(), end, device);
    if (failure != std::errc() || stop != end || device < 0) return error("{}: not the number of a camera", input);
    return open_capture(input, device);
  }
  const fs::path path(input);
  std::error_code code;
  if (!fs::exists(path, code)) {
    if (const auto pattern = parse_pattern(path.filename().string())) {
      return open_pictures(pictures_of_pattern(path, *pattern));
    }
    return error("{}: no such file or directory", input);
  }
  if (fs::is_directory(path, code)) return open_pictures(pictures_in(path));
  std::ifstream stream(path, std::ios::binary);
  std::string start(4096, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(stream.gcount()));
  if (stream.bad() || !stream.is_open()) return error("{}: cannot be read", input);
  if (start.empty()) return error("{}: the file is empty", input);
  if (is_picture_name(path)) return open_pictures(Pictures{.paths = {path}});
  if (is_text(start)) return error("{}: not a video", input);
  return open_capture(input, {});
}

}  // namespace silpose
