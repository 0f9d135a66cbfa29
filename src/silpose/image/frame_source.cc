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
#include "silpose/image/picture_list.h"

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

class PictureSource : public FrameSource {
 public:
  explicit PictureSource(PictureList pictures)
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

Result<std::unique_ptr<FrameSource>> open_pictures(const std::string& input) {
  Result<PictureList> pictures = list_pictures(input);
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
  if (!fs::exists(path, code) || fs::is_directory(path, code) || is_picture_name(path)) return open_pictures(input);
  std::ifstream stream(path, std::ios::binary);
  std::string start(4096, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(stream.gcount()));
  if (stream.bad() || !stream.is_open()) return error("{}: cannot be read", input);
  if (start.empty()) return error("{}: the file is empty", input);
  if (is_text(start)) return error("{}: not a video", input);
  return open_capture(input, {});
}

}  // namespace silpose
