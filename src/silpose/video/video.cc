#include "silpose/video/video.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "silpose/base/clock.h"
#include "silpose/image/frame_source.h"
#include "silpose/video/open_frame_source.h"

namespace silpose {

struct Video::Impl {
  // A source, and its next image where it was read ahead: to know its size and its time. Shared by this video and
  // those of this camera alone.
  struct Camera {
    std::unique_ptr<FrameSource> source;
    std::optional<TimedImage> image;
    int width = 0, height = 0;
    double fps = 0;  // 0: unknown. These two as they were after the first image: a rewound source may forget them.
    int64_t hint = 0;
    int64_t num_read = 0;

    // Reads the next image. False: there is none.
    Result<bool> read() {
      Result<std::optional<TimedImage>> next = source->next();
      if (!next) return next.failure();
      image = std::move(*next);
      if (!image) return false;
      ++num_read;
      if (image->image.channels() != 3) {
        return error("{}: an image of {} channels, not of 3", source->name(), image->image.channels());
      }
      const std::span<const int64_t> numbers = source->numbers();
      if (!numbers.empty() && std::ssize(numbers) < num_read) {
        return error("{}: {} numbers for more images", source->name(), numbers.size());
      }
      return true;
    }
    // Nothing to do where the first image was only read ahead: a file need not be opened again.
    Result<void> rewind() {
      if (num_read == 1 && image) return {};
      image.reset();
      num_read = 0;
      return source->rewind();
    }
  };
  std::vector<std::shared_ptr<Camera>> cameras;
  std::string name;
  double fps = 0;
  bool fps_assumed = false, live = false, ended = false, truncated = false;
  int64_t hint = 0, num_given = 0, last_ns = 0, num_mistimed = 0;
  std::vector<int64_t> numbers;  // of the frames; empty: counted from 0
  Stopwatch since_start;         // the time of live images

  static Result<std::shared_ptr<Camera>> begin(std::unique_ptr<FrameSource> source) {
    auto camera = std::make_shared<Camera>(Camera{.source = std::move(source), .image = {}});
    const Result<bool> first = camera->read();
    if (!first) return first.failure();
    if (!*first) return error("{}: not a video, or no frame in it can be decoded", camera->source->name());
    camera->width = camera->image->image.width();
    camera->height = camera->image->image.height();
    camera->fps = camera->source->fps();
    camera->hint = camera->source->num_frames_hint();
    return camera;
  }

  // Reads what belongs together: cameras whose image is older than another's advance to their next, so that an image
  // that one of them dropped is left out for all. False: one of them has ended.
  Result<bool> read_instant() {
    for (const auto& camera : cameras) {
      if (camera->image) continue;
      const Result<bool> read = camera->read();
      if (!read || !*read) return end_with(*camera, read);
    }
    const auto half_interval = static_cast<int64_t>(0.5e9 / fps);
    for (size_t i = 0; i < cameras.size();) {
      Camera& camera = *cameras[i++];
      const auto is_after = [&](const std::shared_ptr<Camera>& other) {
        return other->image->time_ns && camera.image->time_ns &&
               *other->image->time_ns - *camera.image->time_ns > half_interval;
      };
      if (std::ranges::none_of(cameras, is_after)) continue;
      const Result<bool> read = camera.read();
      if (!read || !*read) return end_with(camera, read);
      i = 0;
    }
    return true;
  }
  Result<bool> end_with(const Camera& camera, const Result<bool>& read) {
    ended = true;
    truncated = camera.source->broke_off();
    return read;
  }

  // The image's own time, or where it has none, or one that does not grow, one frame's after the last.
  int64_t time_of(const Camera& camera, int64_t index) {
    if (live) {
      if (num_given == 0) since_start.restart();
      return num_given == 0 ? 0 : std::llround(since_start.seconds() * 1e9);
    }
    if (!camera.source->has_times()) return std::llround(static_cast<double>(index) * 1e9 / fps);
    const std::optional<int64_t> own = camera.image->time_ns;
    if (own && (num_given == 0 || *own > last_ns)) return *own;
    ++num_mistimed;
    return last_ns + std::llround(1e9 / fps);
  }

  // Numbers that all cameras' images share, as far as the shortest goes.
  void take_numbers() {
    const std::span<const int64_t> first = cameras[0]->source->numbers();
    numbers.assign(first.begin(), first.end());
    for (const auto& camera : cameras) {
      const std::span<const int64_t> other = camera->source->numbers();
      numbers.resize(std::min(numbers.size(), other.size()));
      if (!std::equal(numbers.begin(), numbers.end(), other.begin())) numbers.clear();
    }
  }
  [[nodiscard]] int64_t index_of(int64_t ordinal) const {
    return numbers.empty() ? ordinal : numbers[static_cast<size_t>(std::min(ordinal, std::ssize(numbers) - 1))];
  }
};

Video::Video(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Video::Video(Video&&) noexcept = default;
Video& Video::operator=(Video&&) noexcept = default;
Video::~Video() = default;

int Video::num_cameras() const { return static_cast<int>(impl_->cameras.size()); }
int Video::width(int camera) const { return impl_->cameras.at(static_cast<size_t>(camera))->width; }
int Video::height(int camera) const { return impl_->cameras.at(static_cast<size_t>(camera))->height; }
double Video::fps() const { return impl_->fps; }
bool Video::fps_assumed() const { return impl_->fps_assumed; }
bool Video::is_live() const { return impl_->live; }
int64_t Video::num_frames_hint() const { return impl_->hint; }
int64_t Video::first_index() const { return impl_->index_of(0); }
int64_t Video::own_index(int camera) const {
  const Impl::Camera& asked = *impl_->cameras.at(static_cast<size_t>(camera));
  const std::span<const int64_t> numbers = asked.source->numbers();
  const int64_t ordinal = std::max<int64_t>(0, asked.num_read - 1);
  return numbers.empty() ? ordinal : numbers[static_cast<size_t>(ordinal)];
}
const std::string& Video::name() const { return impl_->name; }
std::optional<double> Video::focal_mm35(int camera) const {
  return impl_->cameras.at(static_cast<size_t>(camera))->source->focal_mm35();
}
bool Video::truncated() const { return impl_->truncated; }

std::vector<std::string> Video::warnings() const {
  std::vector<std::string> all;
  for (const auto& camera : impl_->cameras) {
    const std::vector<std::string> own = camera->source->warnings();
    all.insert(all.end(), own.begin(), own.end());
  }
  if (impl_->num_mistimed > 1 && 100 * impl_->num_mistimed > impl_->num_given) {
    all.push_back(
        fmt::format("{}: {} of its {} frames carry no time, or none after the frame before; put {:.4f} s after it",
                    name(), impl_->num_mistimed, impl_->num_given, 1 / fps()));
  }
  if (impl_->truncated) all.push_back(fmt::format("{}: breaks off before its end", name()));
  return all;
}

Result<std::optional<Frame>> Video::next() {
  Impl& impl = *impl_;
  if (impl.ended) return std::optional<Frame>();
  const Result<bool> read = impl.read_instant();
  if (!read) return read.failure();
  if (!*read) return std::optional<Frame>();
  const int64_t index = impl.index_of(impl.cameras[0]->num_read - 1);
  Frame frame{.index = index, .time_ns = impl.time_of(*impl.cameras[0], index), .images = {}};
  for (const auto& camera : impl.cameras) {
    ByteImage& image = camera->image->image;
    if (image.width() != camera->width || image.height() != camera->height) {
      return error("{}: frame {} is {}x{}, those before it {}x{}", camera->source->name(), frame.index, image.width(),
                   image.height(), camera->width, camera->height);
    }
    frame.images.push_back(std::move(image));
    camera->image.reset();
  }
  impl.last_ns = frame.time_ns;
  ++impl.num_given;
  return std::optional<Frame>(std::move(frame));
}

Result<void> Video::rewind() {
  for (const auto& camera : impl_->cameras) {
    if (Result<void> rewound = camera->rewind(); !rewound) return rewound;
  }
  impl_->num_given = impl_->last_ns = impl_->num_mistimed = 0;
  impl_->ended = impl_->truncated = false;
  return {};
}

Video Video::alone(int camera) {
  auto impl = std::make_unique<Impl>();
  impl->cameras = {impl_->cameras.at(static_cast<size_t>(camera))};
  const Impl::Camera& own = *impl->cameras[0];
  impl->name = own.source->name();
  impl->fps = own.fps > 0 ? own.fps : impl_->fps;
  impl->fps_assumed = own.fps == 0 && impl_->fps_assumed;
  impl->live = own.source->is_live();
  impl->hint = own.hint;
  impl->take_numbers();
  return Video(std::move(impl));
}

Result<Video> join_sources(std::vector<std::unique_ptr<FrameSource>> sources, const VideoOptions& options) {
  check(!sources.empty(), "join_sources: no source");
  check(options.default_fps > 0, "join_sources: default_fps is {}", options.default_fps);
  auto impl = std::make_unique<Video::Impl>();
  for (std::unique_ptr<FrameSource>& source : sources) {
    check(source != nullptr, "join_sources: a null source");
    auto begun = Video::Impl::begin(std::move(source));
    if (!begun) return begun.failure();
    const FrameSource& begun_source = *(*begun)->source;
    const double rate = (*begun)->fps;
    if (rate > 0 && impl->fps > 0 && std::abs(rate - impl->fps) > 0.1 * impl->fps) {
      return error("{}: {:.3f} frames per second, the inputs before it {:.3f}", begun_source.name(), rate, impl->fps);
    }
    if (impl->fps == 0) impl->fps = rate;
    impl->live = impl->live || begun_source.is_live();
    const int64_t hint = (*begun)->hint;
    impl->hint = impl->hint == 0 ? hint : std::min(impl->hint, hint);
    impl->name += (impl->name.empty() ? "" : " ") + begun_source.name();
    impl->cameras.push_back(std::move(*begun));
  }
  impl->take_numbers();
  impl->fps_assumed = impl->fps == 0;
  if (impl->fps_assumed) impl->fps = options.default_fps;
  return Video(std::move(impl));
}

Result<Video> open_video(const std::vector<std::string>& inputs, const VideoOptions& options) {
  check(!inputs.empty(), "open_video: no input");
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (const std::string& input : inputs) {
    auto source = open_frame_source(input);
    if (!source) return source.failure();
    sources.push_back(std::move(*source));
  }
  return join_sources(std::move(sources), options);
}

Result<Video> open_video(const std::string& input, const VideoOptions& options) {
  return open_video(std::vector<std::string>{input}, options);
}

}  // namespace silpose
