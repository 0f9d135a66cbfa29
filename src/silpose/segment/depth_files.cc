#include "silpose/segment/depth_files.h"

#include <algorithm>
#include <utility>

namespace silpose {
namespace {

Result<DepthImage> read(const std::filesystem::path& path, int width, int height) {
  Result<DepthImage> image = read_depth_image(path);
  if (image && (image->width() != width || image->height() != height)) {
    return error("{}: depth of {}x{} for images of {}x{}", path.string(), image->width(), image->height(), width,
                 height);
  }
  return image;
}

}  // namespace

Result<DepthImage> DepthFiles::image_of(int64_t index) const {
  const int64_t number = index - offset;
  auto at = static_cast<size_t>(std::max<int64_t>(number, 0));
  bool found = number >= 0 && at < files.paths.size();
  if (!files.numbers.empty()) {
    const auto place = std::lower_bound(files.numbers.begin(), files.numbers.end(), number);
    at = static_cast<size_t>(place - files.numbers.begin());
    found = place != files.numbers.end() && *place == number;
  }
  if (!found) return error("{}: {} depth images, frame {} has none", name, files.paths.size(), index);
  return read(files.paths[at], width, height);
}

Result<std::vector<DepthImage>> DepthFiles::samples(size_t most, ProgressSink* progress) const {
  std::vector<DepthImage> images;
  const size_t step = (files.paths.size() + most - 1) / most;
  const auto total = static_cast<int64_t>((files.paths.size() + step - 1) / step);
  for (size_t i = 0; i < files.paths.size(); i += step) {
    Result<DepthImage> image = read(files.paths[i], width, height);
    if (!image) return image.failure();
    images.push_back(std::move(*image));
    if (progress != nullptr && !progress->update("background", std::ssize(images), total)) {
      return error("{}: stopped while its background was learned", name);
    }
  }
  return images;
}

}  // namespace silpose
