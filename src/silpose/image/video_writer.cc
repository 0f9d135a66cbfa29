#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "silpose/image/frame_source.h"
#include "silpose/image/video.h"

namespace silpose {

struct VideoWriter::Impl {
  std::string name;
  int width = 0, height = 0;
  cv::Mat padded;  // even sizes, as yuv420p wants
  cv::VideoWriter writer;
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;  // OpenCV's writer ends its file

Result<void> VideoWriter::write(const ByteImage& image) {
  Impl& impl = *impl_;
  check(image.channels() == 1 || image.channels() == 3, "VideoWriter: {} channels", image.channels());
  if (image.width() != impl.width || image.height() != impl.height) {
    return error("{}: a picture of {}x{} for a video of {}x{}", impl.name, image.width(), image.height(), impl.width,
                 impl.height);
  }
  const cv::Mat view(image.height(), image.width(), CV_8UC(image.channels()),
                     const_cast<uint8_t*>(image.pixels().data()));
  try {
    if (!impl.writer.isOpened()) return error("{}: the video is closed", impl.name);
    cv::Mat colour = view;
    if (image.channels() == 1) cv::cvtColor(view, colour, cv::COLOR_GRAY2BGR);
    cv::copyMakeBorder(colour, impl.padded, 0, image.height() % 2, 0, image.width() % 2, cv::BORDER_REPLICATE);
    impl.writer.write(impl.padded);
  } catch (const cv::Exception& exception) {
    return error("{}: a frame cannot be encoded ({})", impl.name, exception.err);
  }
  return {};
}

void VideoWriter::close() { impl_->writer.release(); }

Result<VideoWriter> create_video(const std::filesystem::path& path, int width, int height, double fps) {
  check(width > 0 && height > 0 && fps > 0, "create_video: {}x{} at {} frames a second", width, height, fps);
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::error_code code;
  if (!std::filesystem::is_directory(folder, code)) return error("{}: no such directory", folder.string());
  silence_codecs();
  auto impl = std::make_unique<VideoWriter::Impl>();
  impl->name = path.string();
  impl->width = width;
  impl->height = height;
  try {
    impl->writer.open(std::filesystem::absolute(path).string(), cv::CAP_FFMPEG,
                      cv::VideoWriter::fourcc('a', 'v', 'c', '1'), fps,
                      cv::Size(width + width % 2, height + height % 2), true);
  } catch (const cv::Exception&) {  // the same as not opened
  }
  if (!impl->writer.isOpened()) {
    return error("{}: cannot be written, or there is no H.264 encoder", path.string());
  }
  return VideoWriter(std::move(impl));
}

}  // namespace silpose
