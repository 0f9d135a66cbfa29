#include "silpose/image/image_file.h"

#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silpose {
namespace {

// The decoders print about broken files instead of only failing, or return half an image: so look first whether the
// file continues to its end mark.
bool is_cut_off(std::string_view bytes) {
  if (bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n") {
    for (size_t at = 8; at + 12 <= bytes.size();) {
      uint64_t length = 0;
      for (size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<uint8_t>(bytes[at + i]);
      if (length > bytes.size() - at - 12) return true;
      if (bytes.substr(at + 4, 4) == "IEND") return false;
      at += 12 + length;
    }
    return true;
  }
  if (bytes.substr(0, 2) == "\xff\xd8") {  // JPEG: an end of image after the last start of scan
    const size_t scan = bytes.rfind("\xff\xda"), end = bytes.rfind("\xff\xd9");
    return scan == std::string_view::npos || end == std::string_view::npos || end < scan;
  }
  return false;
}

// Width and height, of a format whose header is easily read: so that a huge image is refused before it takes memory.
std::optional<std::pair<uint64_t, uint64_t>> size_in_header(std::string_view bytes) {
  const auto number = [&](size_t at, size_t length) {
    uint64_t value = 0;
    for (size_t i = 0; i < length; ++i) value = value << 8 | static_cast<uint8_t>(bytes[at + i]);
    return value;
  };
  if (bytes.size() > 24 && bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n") return std::pair(number(16, 4), number(20, 4));
  if (bytes.substr(0, 2) == "\xff\xd8") {  // JPEG: the first start of frame
    for (size_t at = 2; at + 9 <= bytes.size() && bytes[at] == '\xff'; at += 2 + number(at + 2, 2)) {
      const uint64_t marker = number(at + 1, 1);
      const bool starts_frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
      if (starts_frame) return std::pair(number(at + 7, 2), number(at + 5, 2));
    }
  }
  return std::nullopt;
}

// An image as OpenCV reads it under `flags`.
Result<cv::Mat> decode(const std::filesystem::path& path, int flags) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) return error("{}: no such file", path.string());
  if (!std::filesystem::is_regular_file(path, code)) return error("{}: not a file", path.string());
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) return error("{}: cannot be read", path.string());
  if (bytes.empty()) return error("{}: the file is empty", path.string());
  if (is_cut_off(bytes)) return error("{}: the image is cut off", path.string());
  const auto too_large = [&](uint64_t width, uint64_t height) {
    return error("{}: {}x{} are more pixels than the {} that can be handled", path.string(), width, height,
                 kMostPixels);
  };
  const auto size = size_in_header(bytes);
  if (size && size->first * size->second > kMostPixels) return too_large(size->first, size->second);
  cv::Mat decoded;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    decoded = cv::imdecode(encoded, flags);
  } catch (const cv::Exception&) {  // of a size that OpenCV refuses
    decoded.release();
  }
  if (decoded.empty()) return error("{}: not an image", path.string());
  if (decoded.total() > kMostPixels) {
    return too_large(static_cast<uint64_t>(decoded.cols), static_cast<uint64_t>(decoded.rows));
  }
  return decoded;
}

Result<ByteImage> read_image(const std::filesystem::path& path, int channels) {
  const Result<cv::Mat> decoded = decode(path, channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
  if (!decoded) return decoded.failure();
  ByteImage image(decoded->cols, decoded->rows, channels);
  decoded->copyTo(cv::Mat(image.height(), image.width(), CV_8UC(channels), image.pixels().data()));
  return image;
}

cv::Mat view_of(const ByteImage& image) {
  return {image.height(), image.width(), CV_8UC(image.channels()), const_cast<uint8_t*>(image.pixels().data())};
}

Result<void> encode(const std::filesystem::path& path, const cv::Mat& image) {
  std::vector<uint8_t> encoded;
  try {
    if (!cv::imencode(path.extension().string(), image, encoded)) encoded.clear();
  } catch (const cv::Exception&) {
    encoded.clear();
  }
  if (encoded.empty()) return error("{}: no image format for this name", path.string());
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(encoded.data()), static_cast<std::streamsize>(encoded.size()));
  stream.close();
  if (!stream) return error("{}: cannot be written (disk full?)", path.string());
  return {};
}

}  // namespace

Result<ByteImage> read_colour_image(const std::filesystem::path& path) { return read_image(path, 3); }
Result<ByteImage> read_grey_image(const std::filesystem::path& path) { return read_image(path, 1); }

Result<Mask> read_mask(const std::filesystem::path& path) {
  const Result<ByteImage> image = read_grey_image(path);
  if (!image) return image.failure();
  return mask_from_image(*image);
}

Result<void> write_image(const std::filesystem::path& path, const ByteImage& image) {
  check(!image.empty() && (image.channels() == 1 || image.channels() == 3), "write_image: {}x{}x{}", image.width(),
        image.height(), image.channels());
  return encode(path, view_of(image));
}

std::string jpeg_bytes(const ByteImage& image, int quality) {
  check(!image.empty() && (image.channels() == 1 || image.channels() == 3) && quality >= 1 && quality <= 100,
        "jpeg_bytes: {}x{}x{}, quality {}", image.width(), image.height(), image.channels(), quality);
  std::vector<uint8_t> encoded;
  cv::imencode(".jpg", view_of(image), encoded, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {encoded.begin(), encoded.end()};
}

Result<DepthImage> read_depth_image(const std::filesystem::path& path) {
  const Result<cv::Mat> decoded = decode(path, cv::IMREAD_UNCHANGED);
  if (!decoded) return decoded.failure();
  if (decoded->type() != CV_16UC1) {
    return error("{}: {} channels of {} bits, depth is one of 16 (millimetres)", path.string(), decoded->channels(),
                 8 * decoded->elemSize1());
  }
  DepthImage image(decoded->cols, decoded->rows);
  decoded->copyTo(cv::Mat(image.height(), image.width(), CV_16UC1, image.pixels().data()));
  return image;
}

Result<void> write_depth_image(const std::filesystem::path& path, const DepthImage& image) {
  check(!image.empty() && image.channels() == 1, "write_depth_image: {}x{}x{}", image.width(), image.height(),
        image.channels());
  return encode(path, cv::Mat(image.height(), image.width(), CV_16UC1, const_cast<uint16_t*>(image.pixels().data())));
}

Result<void> write_mask(const std::filesystem::path& path, const Mask& mask) {
  return write_image(path, image_from_mask(mask));
}

}  // namespace silpose
