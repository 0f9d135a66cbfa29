#include "silpose/image/memory_source.h"

#include <algorithm>
#include <functional>

#include "silpose/base/check.h"

namespace silpose {

MemorySource::MemorySource(std::vector<ByteImage> images, double fps, std::vector<int64_t> times_ns, std::string name)
    : images_(std::move(images)), fps_(fps), times_ns_(std::move(times_ns)), name_(std::move(name)) {
  check(fps_ >= 0 && fps_ <= 1e6, "MemorySource: {} frames per second", fps_);
  check(times_ns_.empty() || times_ns_.size() == images_.size(), "MemorySource: {} times of {} images",
        times_ns_.size(), images_.size());
  check(std::ranges::adjacent_find(times_ns_, std::greater_equal()) == times_ns_.end(),
        "MemorySource: times that do not grow");
  for (const ByteImage& image : images_) {
    check(image.channels() == 3, "MemorySource: an image of {} channels", image.channels());
  }
}

Result<std::optional<TimedImage>> MemorySource::next() {
  if (next_ == images_.size()) return std::optional<TimedImage>();
  TimedImage image{images_[next_], std::nullopt};
  if (has_times()) image.time_ns = times_ns_[next_] - times_ns_.front();
  ++next_;
  return std::optional(std::move(image));
}

Result<void> MemorySource::rewind() {
  next_ = 0;
  return {};
}

}  // namespace silpose
