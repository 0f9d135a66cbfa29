#include "silpose/video/open_frame_source.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <utility>
#include <vector>

#include "silpose/image/image_file.h"
#include "silpose/image/image_list.h"
#include "silpose/video/ffmpeg.h"
#include "silpose/video/video_file.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

class LiveCamera : public FrameSource {
 public:
  LiveCamera(std::string name, int device) : name_(std::move(name)), device_(device) {}

  Result<void> rewind() override {
    if (capture_.isOpened()) return error("{}: a live camera cannot go back to its first frame", name_);
    if (!capture_.open(device_)) return error("{}: no such camera", name_);
    return {};
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] double fps() const override {
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    return rate > 0 && rate <= 1000 ? rate : 0;
  }
  [[nodiscard]] bool is_live() const override { return true; }

  Result<std::optional<TimedImage>> next() override {
    try {
      cv::Mat view;
      if (!capture_.read(view) || view.empty()) return std::optional<TimedImage>();
      if (view.type() != CV_8UC3) return error("{}: frames are not 8-bit colour", name_);
      ByteImage image(view.cols, view.rows, 3);
      view.copyTo(cv::Mat(view.size(), CV_8UC3, image.pixels().data()));
      return std::optional(TimedImage{std::move(image), std::nullopt});
    } catch (const cv::Exception& exception) {
      return error("{}: cannot be decoded ({})", name_, exception.err);
    }
  }

 private:
  std::string name_;
  int device_;
  mutable cv::VideoCapture capture_;
};

class ImageSource : public FrameSource {
 public:
  ImageSource(std::string name, ImageList images, std::optional<double> focal_mm35)
      : name_(std::move(name)),
        paths_(std::move(images.paths)),
        numbers_(std::move(images.numbers)),
        focal_mm35_(focal_mm35) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::span<const int64_t> numbers() const override { return numbers_; }
  [[nodiscard]] int64_t num_frames_hint() const override { return static_cast<int64_t>(paths_.size()); }
  [[nodiscard]] std::optional<double> focal_mm35() const override { return focal_mm35_; }
  Result<std::optional<TimedImage>> next() override {
    if (next_ == paths_.size()) return std::optional<TimedImage>();
    Result<ByteImage> image = read_colour_image(paths_[next_++]);
    if (!image) return image.failure();
    return std::optional(TimedImage{std::move(*image), std::nullopt});
  }
  Result<void> rewind() override {
    next_ = 0;
    return {};
  }

 private:
  std::string name_;
  std::vector<fs::path> paths_;
  std::vector<int64_t> numbers_;
  std::optional<double> focal_mm35_;  // of the first image
  size_t next_ = 0;
};

// By a JPEG's EXIF. FFmpeg's decoder reads it; OpenCV's has no access to it.
std::optional<double> focal_mm35_of_jpeg(const fs::path& path) {
  const fs::path extension = path.extension();
  if (extension != ".jpg" && extension != ".jpeg" && extension != ".JPG" && extension != ".JPEG") return {};
  const auto image = open_video_file(path.string());
  if (!image || !(*image)->next()) return {};
  return (*image)->focal_mm35();
}

// FFmpeg takes some text files for videos (it draws them).
bool is_text(const std::string& start) {
  return std::all_of(start.begin(), start.end(), [](unsigned char c) { return c >= 32 || (c >= 7 && c <= 13); });
}

Result<std::unique_ptr<FrameSource>> open_camera(const std::string& input, int device) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  silence_ffmpeg();
  auto source = std::make_unique<LiveCamera>(input, device);
  if (const Result<void> opened = source->rewind(); !opened) return opened.failure();
  return std::unique_ptr<FrameSource>(std::move(source));
}

Result<std::unique_ptr<FrameSource>> open_images(const std::string& input) {
  Result<ImageList> images = list_images(input);
  if (!images) return images.failure();
  const std::optional<double> focal_mm35 = focal_mm35_of_jpeg(images->paths.front());
  return std::unique_ptr<FrameSource>(std::make_unique<ImageSource>(input, std::move(*images), focal_mm35));
}

}  // namespace

Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& input) {
  static constexpr std::string_view kCamera = "camera:";
  if (input.starts_with(kCamera)) {
    int device = -1;
    const char* end = input.data() + input.size();
    const auto [stop, failure] = std::from_chars(input.data() + kCamera.size(), end, device);
    if (failure != std::errc() || stop != end || device < 0) return error("{}: not the number of a camera", input);
    return open_camera(input, device);
  }
  const fs::path path(input);
  std::error_code code;
  if (!fs::exists(path, code) || fs::is_directory(path, code) || is_image_name(path)) return open_images(input);
  std::ifstream stream(path, std::ios::binary);
  std::string start(4096, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(stream.gcount()));
  if (stream.bad() || !stream.is_open()) return error("{}: cannot be read", input);
  if (start.empty()) return error("{}: the file is empty", input);
  if (is_text(start)) return error("{}: not a video", input);
  return open_video_file(input);
}

}  // namespace silpose
