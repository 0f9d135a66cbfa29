#include "apps/silpose/observation_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/data_folder.h"
#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"
#include "silpose/image/image_file.h"
#include "silpose/segment/make_segmenter.h"

namespace silpose::app {
namespace {

// One value for all cameras, or one per camera; `fallback` where none is given.
std::string of_camera(const std::string& option, const std::vector<std::string>& values, size_t camera,
                      size_t num_cameras, const std::string& fallback) {
  if (values.empty()) return fallback;
  if (values.size() == 1) return values[0];
  if (values.size() != num_cameras) {
    throw UsageError(fmt::format("{}: given {} times for {} videos", option, values.size(), num_cameras));
  }
  return values[camera];
}

Box parse_region(const std::string& text) {
  const std::vector<double> numbers = parse_numbers("--region", text, 4);
  const bool fits =
      std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::abs(n) < 1e6 && n == std::floor(n); });
  const auto whole = [&](size_t i) { return static_cast<int>(numbers[i]); };
  if (!fits || whole(2) < 1 || whole(3) < 1)
    throw UsageError(fmt::format("--region: {} is not x,y,w,h in whole pixels", text));
  return {whole(0), whole(1), whole(2), whole(3)};
}

CLI::Validator is_key_colour() {
  return CLI::Validator(
      [](const std::string& text) {
        const auto key = parse_key_colour(text);
        return key ? std::string() : key.error().message;
      },
      "");
}

// Options that only one segmenter has.
void check_together(const InputOptions& options) {
  const auto belongs = [&](const char* option, bool given, const char* segmenter) {
    if (given && options.segmenter != segmenter)
      throw UsageError(fmt::format("{}: needs --segmenter {}", option, segmenter));
  };
  belongs("--key-colour", options.key_colour != "auto", "chroma");
  if (!options.depths.empty() && options.segmenter != "depth" && options.segmenter != "background") {
    throw UsageError("--depth: needs --segmenter depth or background");
  }
  belongs("--depth-range", !options.depth_range.empty(), "depth");
  if (options.segmenter == "depth" && options.depths.empty()) throw UsageError("--segmenter depth: needs --depth");
}

std::optional<DepthRange> parse_depth_range(const std::string& text) {
  if (text.empty()) return {};
  const std::vector<double> numbers = parse_numbers("--depth-range", text, 2);
  if (!(numbers[0] >= 0 && numbers[0] < numbers[1] && numbers[1] <= 65.535)) {
    throw UsageError(fmt::format("--depth-range: {} is not MIN,MAX in metres, 0 to 65.535", text));
  }
  return DepthRange{numbers[0], numbers[1]};
}

Result<CleanUpOptions> clean_up_options(const InputOptions& options, const Video& video, size_t camera) {
  const auto count = static_cast<size_t>(video.num_cameras());
  CleanUpOptions clean_up;
  clean_up.grow_px = options.grow_px;
  if (options.min_blob_px) clean_up.min_blob_px = *options.min_blob_px;
  const std::string region = of_camera("--region", options.regions, camera, count, "");
  if (!region.empty()) clean_up.region = parse_region(region);
  const std::string garbage = of_camera("--garbage-mask", options.garbage_masks, camera, count, "");
  if (!garbage.empty()) {
    const Result<Mask> mask = read_mask(garbage);
    if (!mask) return mask.failure();
    const int width = video.width(static_cast<int>(camera)), height = video.height(static_cast<int>(camera));
    if (mask->width() != width || mask->height() != height) {
      return error("{}: {}x{}, but the video is {}x{}", garbage, mask->width(), mask->height(), width, height);
    }
    clean_up.garbage_mask = *mask;
  }
  return clean_up;
}

}  // namespace

void add_input_options(CLI::App& command, InputOptions& options) {
  command.add_option("VIDEO", options.videos, "A file, a folder of pictures, a pattern (img-%06d.png) or camera:N");
  command
      .add_option(
          "--segmenter", options.segmenter,
          "How the person is cut out: masks (given), background, learned (by a network), chroma, depth, or auto: "
          "the first of masks and background that is requested, otherwise learned if scripts/fetch-network-data "
          "has run")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "background", "chroma", "depth", "learned", "masks"}));
  command
      .add_option("--background", options.backgrounds,
                  "auto (from the whole clip), online, lead-in:SECONDS, or a video or picture of the empty scene")
      ->allow_extra_args(false);
  command
      .add_option("--key-colour", options.key_colour,
                  "With chroma: the screen's, as #00b140; auto: the commonest saturated colour of the clip")
      ->capture_default_str()
      ->check(is_key_colour());
  command
      .add_option(
          "--depth", options.depths,
          "With depth, and with background to add to its colours: a folder or pattern of 16-bit pictures in mm, "
          "one per frame, once per camera")
      ->allow_extra_args(false);
  command.add_option("--depth-range", options.depth_range,
                     "MIN,MAX in metres: what lies between is the person; without, what is in front of the scene");
  command.add_option("--masks", options.masks, "Masks made elsewhere: a folder, a pattern or a video, once per camera")
      ->allow_extra_args(false);
  command
      .add_option("--region", options.regions,
                  "x,y,w,h in pixels: a blob counts only if at least half of it lies inside; it is not cut")
      ->allow_extra_args(false);
  command
      .add_option("--garbage-mask", options.garbage_masks,
                  "A picture: what is not white in it is removed from the mask and does not count")
      ->allow_extra_args(false);
  command.add_option("--grow", options.grow_px, "Grows the mask by this many pixels; negative shrinks")
      ->capture_default_str()
      ->check(CLI::Range(-64, 64));
  command
      .add_option("--min-blob", options.min_blob_px, "Pixels below which a blob does not count (0.05 % of the picture)")
      ->check(CLI::Range(0, 100'000'000));
  command
      .add_option("--fps", options.default_fps, "Frames per second of input without a frame rate (30, with a warning)")
      ->check(within(0.1, 10000));
  command.add_option("--start", options.start_s, "Seconds (time_s of the results) to begin at")->check(within(0, 1e6));
  command.add_option("--end", options.end_s, "Seconds to end at, included")->check(within(0, 1e6));
}

Result<ObservationSource> ObservationSource::open(const InputOptions& options) {
  if (options.videos.empty()) throw UsageError("VIDEO is missing");
  if (options.start_s && options.end_s && *options.end_s < *options.start_s) {
    throw UsageError(fmt::format("--start {}: is after --end {}", *options.start_s, *options.end_s));
  }
  check_together(options);
  ObservationSource source;
  source.options_ = options;
  Result<Video> video = open_video(options.videos, options.video_options());
  if (!video) return video.failure();
  source.video_ = std::make_unique<Video>(std::move(*video));
  const Video& opened = *source.video_;
  if (opened.fps_assumed() && !options.default_fps) {
    source.warnings_.push_back(
        fmt::format("{}: has no frame rate, {} frames per second assumed", opened.name(), opened.fps()));
  }
  // A quarter of a frame's time makes up for rounded time stamps.
  const double margin_s = 0.25 / opened.fps();
  source.start_ns_ = std::llround((options.start_s.value_or(0) - margin_s) * 1e9);
  source.end_ns_ =
      options.end_s ? std::llround((*options.end_s + margin_s) * 1e9) : std::numeric_limits<int64_t>::max();

  return source;
}

Result<void> ObservationSource::learn(Console& console) {
  const Stopwatch learning;
  segmenters_.clear();
  const auto count = static_cast<size_t>(video_->num_cameras());
  for (size_t camera = 0; camera < count; ++camera) {
    SegmenterOptions segmenter;
    segmenter.kind = options_.segmenter;
    const std::string background = of_camera("--background", options_.backgrounds, camera, count, "");
    if (!background.empty()) {
      Result<BackgroundOrigin> origin = background_origin_of(background);
      if (!origin) return origin.failure();
      segmenter.background = std::move(*origin);
    }
    segmenter.networks = (data_directory() / "networks").string();
    segmenter.masks = of_camera("--masks", options_.masks, camera, count, "");
    segmenter.key_colour = parse_key_colour(options_.key_colour).value();
    segmenter.depth = of_camera("--depth", options_.depths, camera, count, "");
    segmenter.depth_range = parse_depth_range(options_.depth_range);
    const Result<CleanUpOptions> clean_up = clean_up_options(options_, *video_, camera);
    if (!clean_up) return clean_up.failure();
    segmenter.clean_up = *clean_up;
    Video alone = video_->alone(static_cast<int>(camera));
    Result<std::unique_ptr<Segmenter>> made = make_segmenter(alone, segmenter, &console);
    if (!made) return made.failure();
    segmenters_.push_back(std::move(*made));
  }
  if (Result<void> rewound = video_->rewind(); !rewound) return rewound;
  learning_s_ += learning.seconds();
  num_seen_ = num_cut_ = 0;
  first_state_ = state();
  return {};
}

Result<void> ObservationSource::rewind(Console& console) {
  if (Result<void> done = ahead_->finish(); !done) return done;
  next_.reset();
  stride_ = 1;
  num_wanted_ = 0;
  if (!std::ranges::all_of(segmenters_, [](const auto& segmenter) { return segmenter->can_go_back(); })) {
    return learn(console);
  }
  restore(first_state_);
  return video_->rewind();
}

Result<Video*> ObservationSource::videos_again() {
  if (Result<void> done = ahead_->finish(); !done) return done.failure();
  next_.reset();
  video_warnings_ = video_->warnings();  // a shorter pass would not find them all again
  if (Result<void> rewound = video_->rewind(); !rewound) return rewound.failure();
  return video_.get();
}

void ObservationSource::expect(std::vector<Mask> silhouettes) {
  for (size_t camera = 0; camera < silhouettes.size(); ++camera) {
    segmenters_[camera]->expect(std::move(silhouettes[camera]));
  }
}

Result<std::optional<Instant>> ObservationSource::next() { return read(true); }

Result<std::optional<Frame>> ObservationSource::skip() {
  Result<std::optional<Instant>> instant = read(false);
  if (!instant) return instant.failure();
  if (!instant->has_value()) return std::optional<Frame>();
  return std::optional<Frame>(std::move((*instant)->frame));
}

std::string ObservationSource::state() const {
  std::vector<std::string> of_segmenters;
  for (const auto& segmenter : segmenters_) of_segmenters.push_back(segmenter->state());
  return to_bytes(of_segmenters, num_seen_, num_cut_);
}

void ObservationSource::restore(std::string_view state) {
  std::vector<std::string> of_segmenters;
  check(from_bytes(state, of_segmenters, num_seen_, num_cut_) && of_segmenters.size() == segmenters_.size(),
        "ObservationSource: not a state of it");
  for (size_t camera = 0; camera < segmenters_.size(); ++camera) segmenters_[camera]->restore(of_segmenters[camera]);
}

void ObservationSource::thin_out_to(int64_t count) {
  constexpr int64_t kUnknownLength = 4;
  stride_ = num_expected() > 0 ? (num_expected() + count - 1) / count : kUnknownLength;
}

bool ObservationSource::may_be_tracked(const Frame& frame) const {
  if (frame.time_ns < start_ns_ || frame.time_ns > end_ns_) return false;
  for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
    if (video_->own_index(static_cast<int>(camera)) < segmenters_[camera]->first_index()) return false;
  }
  return true;
}

void ObservationSource::read_ahead() {
  next_ = std::make_unique<Read>();
  Result<void> given = ahead_->give([this, to = next_.get()]() -> Result<void> {
    Stopwatch stopwatch;
    to->frame = video_->next();
    to->decode_s = stopwatch.restart();
    if (!to->frame || !to->frame->has_value() || stride_ > 1 || !may_be_tracked(**to->frame)) return {};
    for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
      segmenters_[camera]->prepare((*to->frame)->images[camera], video_->own_index(static_cast<int>(camera)));
    }
    to->prepare_s = stopwatch.seconds();
    return {};
  });
  check(given.ok(), "ObservationSource: its jobs report their failures elsewhere");
}

Result<ObservationSource::Read> ObservationSource::read_frame() {
  if (!next_) {
    const Stopwatch stopwatch;
    Read read{.frame = video_->next()};
    read.decode_s = stopwatch.seconds();
    return read;
  }
  if (Result<void> done = ahead_->finish(); !done) return done.failure();
  return std::move(*std::exchange(next_, nullptr));
}

Result<std::optional<Instant>> ObservationSource::read(bool segments) {
  Instant instant;
  for (;;) {
    Result<Read> read = read_frame();
    if (!read) return read.failure();
    Result<std::optional<Frame>>& frame = read->frame;
    if (!frame) return frame.failure();
    if (!frame->has_value() || (*frame)->time_ns > end_ns_) return std::optional<Instant>();
    instant.decode_s += read->decode_s;
    instant.segment_s += read->prepare_s;
    const bool wanted = may_be_tracked(**frame) && num_wanted_++ % stride_ == 0;
    for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
      if (!(wanted && segments) && !segmenters_[camera]->sees_all()) continue;
      const Stopwatch segmenting;
      Result<Observation> seen =
          segmenters_[camera]->segment((*frame)->images[camera], video_->own_index(static_cast<int>(camera)));
      instant.segment_s += segmenting.seconds();
      if (!seen) return seen.failure();
      if (wanted) instant.observations.push_back(std::move(*seen));
    }
    if (!wanted) {
      if (Console::interrupted()) return std::optional<Instant>();
      continue;
    }
    for (const Observation& seen : instant.observations) {  // restore() sets it where they are skipped
      num_seen_ += seen.trust.nothing_found ? 0 : 1;
      num_cut_ += seen.trust.touches_border ? 1 : 0;
    }
    instant.frame = std::move(**frame);
    if (segments && !video_->is_live()) read_ahead();  // a live picture should be the newest one
    return std::optional<Instant>(std::move(instant));
  }
}

std::vector<PictureSize> ObservationSource::sizes() const {
  std::vector<PictureSize> sizes;
  sizes.reserve(static_cast<size_t>(video_->num_cameras()));
  for (int c = 0; c < video_->num_cameras(); ++c)
    sizes.push_back({video_->width(c), video_->height(c), video_->focal_mm35(c)});
  return sizes;
}

int64_t ObservationSource::num_expected() const {
  if (video_->num_frames_hint() <= 0) return 0;
  // As if the rate were constant.
  const auto frame_at = [&](int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9 * video_->fps(); };
  const int64_t before = video_->first_index();
  const auto end = std::min(static_cast<double>(before + video_->num_frames_hint() - 1), frame_at(end_ns_)) + 1;
  auto first = std::max(static_cast<double>(before), std::ceil(frame_at(start_ns_)));
  for (const auto& segmenter : segmenters_) first = std::max(first, static_cast<double>(segmenter->first_index()));
  return std::max<int64_t>(0, static_cast<int64_t>(end - first));
}

std::string ObservationSource::background() const {
  std::string names;
  for (const auto& segmenter : segmenters_) {
    if (names.find(segmenter->name()) == std::string::npos) names += (names.empty() ? "" : ", ") + segmenter->name();
  }
  return names;
}

bool ObservationSource::finds_keypoints() const {
  return std::ranges::any_of(segmenters_, [](const auto& segmenter) { return segmenter->finds_keypoints(); });
}

std::vector<std::string> ObservationSource::warnings() const {
  (void)ahead_->finish();  // next() reports its failure
  std::vector<std::string> all = warnings_;
  for (const auto& segmenter : segmenters_) {
    const std::vector<std::string> own = segmenter->warnings();
    all.insert(all.end(), own.begin(), own.end());
  }
  if (2 * num_cut_ > num_seen_) {
    all.push_back(
        fmt::format("{}: the subject reaches the edge of the picture in {:.0f} % of the masks; a whole body is "
                    "assumed, and what lies outside is guessed",
                    video_->name(), 100.0 * static_cast<double>(num_cut_) / static_cast<double>(num_seen_)));
  }
  const std::vector<std::string> of_video = video_warnings_ ? *video_warnings_ : video_->warnings();
  all.insert(all.end(), of_video.begin(), of_video.end());
  return all;
}

}  // namespace silpose::app
