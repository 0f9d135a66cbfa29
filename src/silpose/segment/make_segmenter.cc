#include "silpose/segment/make_segmenter.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "silpose/image/video.h"
#include "silpose/segment/background_doubt.h"
#include "silpose/segment/background_model.h"
#include "silpose/segment/background_segmenter.h"
#include "silpose/segment/chroma_segmenter.h"
#include "silpose/segment/depth_files.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/depth_segmenter.h"
#include "silpose/segment/given_masks.h"
#include "silpose/segment/learned_segmenter.h"
#include "silpose/segment/person_network.h"
#include "silpose/segment/screen_model.h"

namespace silpose {
namespace {

// Fractions of the picture (or the region) from which a warning is due.
constexpr double kMuchHalfCovered = 0.002, kLittleMoves = 0.002;

std::vector<std::string> doubts(const std::string& input, const BackgroundModel& model,
                                const BackgroundSamples& samples, const CleanUpOptions& clean_up) {
  const BackgroundDoubt doubt = doubt_background(model, samples, clean_up.region);
  if (doubt.ever_covered < kLittleMoves) {
    return {
        fmt::format("{}: almost nothing moves in this clip; a static subject is mistaken for background "
                    "(--background with a plate or lead-in:SECONDS helps)",
                    input)};
  }
  if (doubt.half_covered > kMuchHalfCovered) {
    return {fmt::format(
        "{}: in {:.1f} % of the picture something stays for a large part of the clip; a subject who does not "
        "move may have been mistaken for background (--background with a plate or lead-in:SECONDS helps)",
        input, 100 * doubt.half_covered)};
  }
  return {};
}

Result<void> check_sizes(const std::string& input, const Video& video, const CleanUpOptions& clean_up) {
  const int width = video.width(), height = video.height();
  if (clean_up.garbage_mask && (clean_up.garbage_mask->width() != width || clean_up.garbage_mask->height() != height)) {
    return error("{}: pictures of {}x{}, the garbage mask is {}x{}", input, width, height,
                 clean_up.garbage_mask->width(), clean_up.garbage_mask->height());
  }
  if (const auto& region = clean_up.region) {
    if (region->x >= width || region->y >= height || region->x + region->width <= 0 ||
        region->y + region->height <= 0) {
      return error("{}: the region {},{},{},{} lies outside its pictures of {}x{}", input, region->x, region->y,
                   region->width, region->height, width, height);
    }
  }
  return {};
}

Result<Video> open_input(const std::string& input, const SegmenterOptions& options) {
  Result<Video> video = open_video(input, {.default_fps = options.default_fps});
  if (!video) return video;
  if (const auto fits = check_sizes(input, *video, options.clean_up); !fits) return fits.failure();
  return video;
}

// What to add to the number of one of `count` pictures (masks, depth), the first numbered `first`, for the number of
// its frame. As many as frames (a container's own count may be off by one) belong together in their order, whatever
// number they begin with; others by their numbers.
Result<int64_t> offset_to_frames(const std::string& name, const char* what, int64_t first, int64_t count,
                                 const Video& video) {
  const int64_t num_frames = video.num_frames_hint();
  const int64_t offset = std::abs(count - num_frames) <= 1 ? video.first_index() - first : 0;
  const int64_t end = first + offset + count, frames_end = video.first_index() + num_frames;
  if (count > 0 && num_frames > 0 && (end + 1 < frames_end || first + offset >= frames_end)) {
    return error("{}: {} {} for {} frames of {}", name, count, what, num_frames, video.name());
  }
  return offset;
}

Result<std::unique_ptr<Segmenter>> make_masks(const std::string& input, const SegmenterOptions& options) {
  Result<Video> video = open_input(input, options);
  if (!video) return video.failure();
  if (options.masks.empty()) {
    std::vector<std::string> warnings;
    if (options.kind == "auto") {
      warnings.push_back(fmt::format("{}: black and white only, so used as masks (--segmenter overrides this)", input));
    }
    return make_given_masks(input, {}, 0, options.clean_up, std::move(warnings));
  }
  Result<Video> masks = open_video(options.masks, {.default_fps = options.default_fps});
  if (!masks) return masks.failure();
  if (masks->width() != video->width() || masks->height() != video->height()) {
    return error("{}: masks of {}x{} for pictures of {}x{}", options.masks, masks->width(), masks->height(),
                 video->width(), video->height());
  }
  const Result<int64_t> offset =
      offset_to_frames(options.masks, "masks", masks->first_index(), masks->num_frames_hint(), *video);
  if (!offset) return offset.failure();
  return make_given_masks(options.masks, std::move(*masks), *offset, options.clean_up);
}

// A picture, or a clip of the empty scene.
Result<BackgroundModel> model_from_plate(const std::string& plate, const std::string& input, Video& video,
                                         ProgressSink* progress) {
  Result<Video> plates = open_video(plate);
  if (!plates) return plates.failure();
  if (plates->width() != video.width() || plates->height() != video.height()) {
    return error("{}: a background of {}x{} for pictures of {}x{} in {}", plate, plates->width(), plates->height(),
                 video.width(), video.height(), input);
  }
  Result<std::optional<Frame>> first = plates->next();
  if (!first) return first.failure();
  Result<std::optional<Frame>> second = plates->next();
  if (!second) return second.failure();
  if (second->has_value()) {
    if (const auto rewound = plates->rewind(); !rewound) return rewound.failure();
    Result<BackgroundSamples> samples = sample_background(*plates, {}, progress);
    if (!samples) return samples.failure();
    return learn_background(*samples);
  }
  BackgroundSamples samples;
  if (!video.is_live()) {
    Result<BackgroundSamples> of_clip = sample_background(video, {}, progress);
    if (!of_clip) return of_clip.failure();
    samples = std::move(*of_clip);
  }
  return background_from_plate((*first)->images[0], samples);
}

Result<DepthFiles> open_depth(const SegmenterOptions& options, const Video& video) {
  Result<PictureList> files = list_pictures(options.depth);
  if (!files) return files.failure();
  DepthFiles depth{.name = options.depth, .files = std::move(*files), .width = video.width(), .height = video.height()};
  const Result<int64_t> offset =
      offset_to_frames(depth.name, "depth images", depth.first_number(), std::ssize(depth.files.paths), video);
  if (!offset) return offset.failure();
  depth.offset = *offset;
  return depth;
}

Result<std::unique_ptr<Segmenter>> make_background(const std::string& input, const SegmenterOptions& options,
                                                   ProgressSink* progress) {
  Result<Video> opened = open_input(input, options);
  if (!opened) return opened.failure();
  Video& video = *opened;
  const std::string background = options.background.empty() ? "auto" : options.background;
  BackgroundSegmenterOptions made{
      .name = "background " + background, .first_index = 0, .warnings = {}, .clean_up = options.clean_up, .depth = {}};
  if (!options.depth.empty()) {
    if (video.is_live() || background.starts_with("online")) {
      return error("{}: depth joins a background that is learned beforehand, not an online one", input);
    }
    Result<DepthFiles> depth = open_depth(options, video);
    if (!depth) return depth.failure();
    const Result<std::vector<DepthImage>> samples = depth->samples(kDepthSamples, progress);
    if (!samples) return samples.failure();
    made.name += " with depth";
    made.depth = JoinedDepth{std::move(*depth), learn_depth_background(*samples)};
  }

  if (background == "online" || background == "online:knn" || (background == "auto" && video.is_live())) {
    const bool knn = background == "online:knn";
    if (!knn) made.name = "background online";
    return make_online_segmenter(knn ? OnlineMixture::kKnn : OnlineMixture::kMog2, std::move(made));
  }
  if (background == "auto") {
    Result<BackgroundSamples> samples = sample_background(video, {}, progress);
    if (!samples) return samples.failure();
    BackgroundModel model = learn_background(*samples);
    made.warnings = doubts(input, model, *samples, options.clean_up);
    return make_background_segmenter(std::move(model), std::move(made));
  }
  static constexpr std::string_view kLeadIn = "lead-in:";
  if (background.starts_with(kLeadIn)) {
    const char* end = background.data() + background.size();
    double seconds = 0;
    const auto [stop, failure] = std::from_chars(background.data() + kLeadIn.size(), end, seconds);
    if (failure != std::errc() || stop != end || !(seconds > 0) || seconds > 1e6) {
      return error("background '{}': lead-in wants a positive number of seconds", background);
    }
    if (video.is_live()) return error("{}: the background of a live camera is learned online", input);
    Result<BackgroundSamples> samples = sample_background(video, std::llround(seconds * 1e9), progress);
    if (!samples) return samples.failure();
    if (!samples->next_index) return error("{}: ends within its lead-in of {} s", input, seconds);
    made.first_index = *samples->next_index;
    return make_background_segmenter(learn_background(*samples), std::move(made));
  }
  Result<BackgroundModel> model = model_from_plate(background, input, video, progress);
  if (!model) return model.failure();
  return make_background_segmenter(std::move(*model), std::move(made));
}

Result<std::unique_ptr<Segmenter>> make_learned(const std::string& input, const SegmenterOptions& options,
                                                ProgressSink* progress) {
  Result<Video> video = open_input(input, options);
  if (!video) return video.failure();
  Result<PersonNetwork> network = PersonNetwork::load(options.networks);
  if (!network) return network.failure();
  Result<PersonDetector> detector = PersonDetector::load(options.networks);
  if (!detector) return detector.failure();
  if (video->is_live()) return make_learned_segmenter(std::move(*network), std::move(*detector), options.clean_up);
  Result<BackgroundSamples> samples = sample_background(*video, {}, progress);
  if (!samples) return samples.failure();
  return make_learned_segmenter(std::move(*network), std::move(*detector), options.clean_up, *samples);
}

Result<std::unique_ptr<Segmenter>> make_chroma(const std::string& input, const SegmenterOptions& options,
                                               ProgressSink* progress) {
  Result<Video> video = open_input(input, options);
  if (!video) return video.failure();
  if (video->is_live())
    return error("{}: the screen is learned from the whole clip, which a live camera has not", input);
  const Result<BackgroundSamples> samples = sample_background(*video, {}, progress);
  if (!samples) return samples.failure();
  Result<ScreenModel> model = learn_screen(*samples, options.key_colour, options.clean_up.garbage_mask);
  if (!model) return error("{}: {}", input, model.error().message);
  return make_chroma_segmenter(std::move(*model), input, options.clean_up);
}

Result<std::unique_ptr<Segmenter>> make_depth(const std::string& input, const SegmenterOptions& options,
                                              ProgressSink* progress) {
  if (options.depth.empty()) return error("segmenter 'depth': no depth images are given");
  Result<Video> video = open_input(input, options);
  if (!video) return video.failure();
  Result<DepthFiles> depth = open_depth(options, *video);
  if (!depth) return depth.failure();
  return make_depth_segmenter(std::move(*depth), options.depth_range, options.clean_up, progress);
}

Result<std::string> chosen_kind(const std::string& input, const SegmenterOptions& options) {
  if (options.kind != "auto") return options.kind;
  if (!options.masks.empty()) return std::string("masks");
  if (options.background.empty()) {
    Result<Video> video = open_input(input, options);
    if (!video) return video.failure();
    const Result<bool> masks = video->is_live() ? false : shows_masks(*video);
    if (!masks) return masks.failure();
    if (*masks) return std::string("masks");
  }
  return std::string(options.background.empty() && has_person_networks(options.networks) ? "learned" : "background");
}

}  // namespace

Result<std::unique_ptr<Segmenter>> make_segmenter(const std::string& input, const SegmenterOptions& options,
                                                  ProgressSink* progress) {
  options.clean_up.check();
  const Result<std::string> chosen = chosen_kind(input, options);
  if (!chosen) return chosen.failure();
  const std::string& kind = *chosen;
  if (kind == "masks") return make_masks(input, options);
  if (kind == "learned") return make_learned(input, options, progress);
  if (kind == "background") return make_background(input, options, progress);
  if (kind == "chroma") return make_chroma(input, options, progress);
  if (kind == "depth") return make_depth(input, options, progress);
  return error("segmenter '{}': unknown; known are auto, background, chroma, depth, learned, masks", kind);
}

}  // namespace silpose
