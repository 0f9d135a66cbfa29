#include "silpose/image/video.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "silpose/base/clock.h"
#include "silpose/image/frame_source.h"

namespace silpose {

struct Video::Impl {
  struct Camera {
    std::string input;
    std::unique_ptr<FrameSource> source;
    std::optional<ByteImage> first;  // read ahead, to know the size and that there is a picture at all
    int width = 0, height = 0;
  };
  std::vector<Camera> cameras;
  std::string name;
  double fps = 0;
  bool fps_assumed = false, live = false, ended = false, truncated = false;
  int64_t hint = 0, num_read = 0;
  std::vector<int64_t> numbers;  // of the frames; empty: counted from 0
  Stopwatch since_start;         // the time of live pictures

  static Result<Camera> open_camera(const std::string& input) {
    auto source = open_frame_source(input);
    if (!source) return source.failure();
    Camera camera{.input = input, .source = std::move(*source), .first = {}};
    Result<std::optional<ByteImage>> first = camera.source->next();
    if (!first) return first.failure();
    if (!first->has_value()) return error("{}: not a video, or no frame in it can be decoded", input);
    camera.first = std::move(*first);
    camera.width = camera.first->width();
    camera.height = camera.first->height();
    return camera;
  }

  // A container's count may be off by a frame or so (edit lists, a duration that is rounded).
  [[nodiscard]] bool ends_early() const { return hint - num_read > std::max<int64_t>(2, hint / 100); }

  // Numbers that all cameras' pictures share, as far as the shortest goes.
  void take_numbers() {
    const std::span<const int64_t> first = cameras[0].source->numbers();
    numbers.assign(first.begin(), first.end());
    for (const Camera& camera : cameras) {
      const std::span<const int64_t> other = camera.source->numbers();
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
int Video::width(int camera) const { return impl_->cameras.at(static_cast<size_t>(camera)).width; }
int Video::height(int camera) const { return impl_->cameras.at(static_cast<size_t>(camera)).height; }
double Video::fps() const { return impl_->fps; }
bool Video::fps_assumed() const { return impl_->fps_assumed; }
bool Video::is_live() const { return impl_->live; }
int64_t Video::num_frames_hint() const { return impl_->hint; }
int64_t Video::first_index() const { return impl_->index_of(0); }
int64_t Video::own_index(int camera) const {
  const std::span<const int64_t> numbers = impl_->cameras.at(static_cast<size_t>(camera)).source->numbers();
  const int64_t ordinal = std::max<int64_t>(0, impl_->num_read - 1);
  return numbers.empty() ? ordinal : numbers[static_cast<size_t>(ordinal)];
}
const std::string& Video::name() const { return impl_->name; }
bool Video::truncated() const { return impl_->truncated; }

Result<std::optional<Frame>> Video::next() {
  Impl& impl = *impl_;
  if (impl.ended) return std::optional<Frame>();
  Frame frame{.index = impl.index_of(impl.num_read), .time_ns = 0, .images = {}};
  if (impl.live) {
    if (impl.num_read == 0) impl.since_start.restart();
    frame.time_ns = impl.num_read == 0 ? 0 : std::llround(impl.since_start.seconds() * 1e9);
  } else {
    frame.time_ns = std::llround(static_cast<double>(frame.index) * 1e9 / impl.fps);
  }
  for (Impl::Camera& camera : impl.cameras) {
    Result<std::optional<ByteImage>> image = std::move(camera.first);
    camera.first.reset();
    if (!image->has_value()) image = camera.source->next();
    if (!image) return image.failure();
    if (!image->has_value()) {  // several cameras end with the first that ends
      impl.ended = true;
      impl.truncated = impl.ends_early();
      return std::optional<Frame>();
    }
    ByteImage& picture = **image;
    if (picture.width() != camera.width || picture.height() != camera.height) {
      return error("{}: frame {} is {}x{}, those before it {}x{}", camera.input, frame.index, picture.width(),
                   picture.height(), camera.width, camera.height);
    }
    frame.images.push_back(std::move(picture));
  }
  ++impl.num_read;
  return std::optional<Frame>(std::move(frame));
}

Result<void> Video::rewind() {
  for (Impl::Camera& camera : impl_->cameras) {
    camera.first.reset();
    if (Result<void> rewound = camera.source->rewind(); !rewound) return rewound;
  }
  impl_->num_read = 0;
  impl_->ended = impl_->truncated = false;
  return {};
}

Result<Video> open_video(const std::vector<std::string>& inputs, const VideoOptions& options) {
  check(!inputs.empty(), "open_video: no input");
  check(options.default_fps > 0, "open_video: default_fps is {}", options.default_fps);
  auto impl = std::make_unique<Video::Impl>();
  for (const std::string& input : inputs) {
    auto camera = Video::Impl::open_camera(input);
    if (!camera) return camera.failure();
    const double rate = camera->source->fps();
    if (rate > 0 && impl->fps > 0 && std::abs(rate - impl->fps) > 0.01 * impl->fps) {
      return error("{}: {:.3f} frames a second, the inputs before it {:.3f}", input, rate, impl->fps);
    }
    if (impl->fps == 0) impl->fps = rate;
    impl->live = impl->live || camera->source->is_live();
    const int64_t hint = camera->source->num_frames_hint();
    impl->hint = impl->hint == 0 ? hint : std::min(impl->hint, hint);
    impl->name += (impl->name.empty() ? "" : " ") + input;
    impl->cameras.push_back(std::move(*camera));
  }
  impl->take_numbers();
  impl->fps_assumed = impl->fps == 0;
  if (impl->fps_assumed) impl->fps = options.default_fps;
  return Video(std::move(impl));
}

Result<Video> open_video(const std::string& input, const VideoOptions& options) {
  return open_video(std::vector<std::string>{input}, options);
}

}  // namespace silpose
