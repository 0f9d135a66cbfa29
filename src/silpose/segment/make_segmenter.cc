#include "silpose/segment/make_segmenter.h"

#include <cmath>
#include <utility>

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

// [guess] Fractions of the image (or the region) from which a warning is due.
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
    return {
        fmt::format("{}: in {:.1f} % of the image something stays for a large part of the clip; a subject who does not "
                    "move may have been mistaken for background (--background with a plate or lead-in:SECONDS helps)",
                    input, 100 * doubt.half_covered)};
  }
  return {};
}

Result<void> check_sizes(const Video& video, const CleanUpOptions& clean_up) {
  const int width = video.width(), height = video.height();
  if (clean_up.garbage_mask && (clean_up.garbage_mask->width() != width || clean_up.garbage_mask->height() != height)) {
    return error("{}: images of {}x{}, the garbage mask is {}x{}", video.name(), width, height,
                 clean_up.garbage_mask->width(), clean_up.garbage_mask->height());
  }
  if (const auto& region = clean_up.region) {
    if (region->x >= width || region->y >= height || region->x + region->width <= 0 ||
        region->y + region->height <= 0) {
      return error("{}: the region {},{},{},{} lies outside its images of {}x{}", video.name(), region->x, region->y,
                   region->width, region->height, width, height);
    }
  }
  return {};
}

// What to add to the number of one of `count` images (masks, depth), the first numbered `first`, for the number of
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

Result<std::unique_ptr<Segmenter>> make_masks(const Video& video, const SegmenterOptions& options) {
  if (options.masks.empty()) {
    std::vector<std::string> warnings;
    if (options.kind == "auto") {
      warnings.push_back(
          fmt::format("{}: black and white only, so used as masks (--segmenter overrides this)", video.name()));
    }
    return make_given_masks(video.name(), {}, 0, options.clean_up, std::move(warnings));
  }
  Result<Video> masks = open_video(options.masks, {.default_fps = video.fps()});
  if (!masks) return masks.failure();
  if (masks->width() != video.width() || masks->height() != video.height()) {
    return error("{}: masks of {}x{} for images of {}x{}", options.masks, masks->width(), masks->height(),
                 video.width(), video.height());
  }
  const Result<int64_t> offset =
      offset_to_frames(options.masks, "masks", masks->first_index(), masks->num_frames_hint(), video);
  if (!offset) return offset.failure();
  return make_given_masks(options.masks, std::move(*masks), *offset, options.clean_up);
}

// Samples of the whole video, or of its beginning.
Result<BackgroundSamples> sample(Video& video, std::optional<int64_t> end_ns, ProgressSink* progress) {
  if (Result<void> rewound = video.rewind(); !rewound) return rewound.failure();
  return sample_background(video, end_ns, progress);
}

// An image, or a clip of the empty scene.
Result<BackgroundModel> model_from_plate(const std::string& plate, Video& video, ProgressSink* progress) {
  Result<Video> plates = open_video(plate);
  if (!plates) return plates.failure();
  if (plates->width() != video.width() || plates->height() != video.height()) {
    return error("{}: a background of {}x{} for images of {}x{} in {}", plate, plates->width(), plates->height(),
                 video.width(), video.height(), video.name());
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
    Result<BackgroundSamples> of_clip = sample(video, {}, progress);
    if (!of_clip) return of_clip.failure();
    samples = std::move(*of_clip);
  }
  return background_from_plate((*first)->images[0], samples);
}

Result<DepthFiles> open_depth(const SegmenterOptions& options, const Video& video) {
  Result<ImageList> files = list_images(options.depth);
  if (!files) return files.failure();
  DepthFiles depth{.name = options.depth, .files = std::move(*files), .width = video.width(), .height = video.height()};
  const Result<int64_t> offset =
      offset_to_frames(depth.name, "depth images", depth.first_number(), std::ssize(depth.files.paths), video);
  if (!offset) return offset.failure();
  depth.offset = *offset;
  return depth;
}

Result<std::unique_ptr<Segmenter>> make_background(Video& video, const SegmenterOptions& options,
                                                   ProgressSink* progress) {
  const std::string& input = video.name();
  BackgroundOrigin origin = options.background.value_or(BackgroundOfClip{});
  BackgroundSegmenterOptions made{.name = "background " + text_of(origin),
                                  .first_index = 0,
                                  .warnings = {},
                                  .clean_up = options.clean_up,
                                  .depth = {}};
  if (video.is_live() && std::holds_alternative<BackgroundOfClip>(origin)) {
    origin = BackgroundOnline{};
    made.name = "background online";
  }
  if (!options.depth.empty()) {
    if (std::holds_alternative<BackgroundOnline>(origin)) {
      return error("{}: depth joins a background that is learned beforehand, not an online one", input);
    }
    Result<DepthFiles> depth = open_depth(options, video);
    if (!depth) return depth.failure();
    const Result<std::vector<DepthImage>> samples = depth->samples(kDepthSamples, progress);
    if (!samples) return samples.failure();
    made.name += " with depth";
    made.depth = JoinedDepth{std::move(*depth), learn_depth_background(*samples)};
  }

  if (const auto* online = std::get_if<BackgroundOnline>(&origin)) {
    return make_online_segmenter(online->knn ? OnlineMixture::kKnn : OnlineMixture::kMog2, std::move(made));
  }
  if (const auto* lead_in = std::get_if<BackgroundLeadIn>(&origin)) {
    check(lead_in->seconds > 0 && lead_in->seconds <= kLongestLeadIn_s, "make_segmenter: a lead-in of {} s",
          lead_in->seconds);
    if (video.is_live()) return error("{}: the background of a live camera is learned online", input);
    Result<BackgroundSamples> samples = sample(video, std::llround(lead_in->seconds * 1e9), progress);
    if (!samples) return samples.failure();
    if (!samples->next_index) return error("{}: ends within its lead-in of {} s", input, lead_in->seconds);
    made.first_index = *samples->next_index;
    return make_background_segmenter(learn_background(*samples), std::move(made));
  }
  if (const auto* plate = std::get_if<BackgroundPlate>(&origin)) {
    Result<BackgroundModel> model = model_from_plate(plate->path, video, progress);
    if (!model) return model.failure();
    return make_background_segmenter(std::move(*model), std::move(made));
  }
  Result<BackgroundSamples> samples = sample(video, {}, progress);
  if (!samples) return samples.failure();
  BackgroundModel model = learn_background(*samples);
  made.warnings = doubts(input, model, *samples, options.clean_up);
  return make_background_segmenter(std::move(model), std::move(made));
}

Result<std::unique_ptr<Segmenter>> make_learned(Video& video, const SegmenterOptions& options, ProgressSink* progress) {
  Result<PersonNetwork> network = PersonNetwork::load(options.networks);
  if (!network) return network.failure();
  Result<PersonDetector> detector = PersonDetector::load(options.networks);
  if (!detector) return detector.failure();
  if (video.is_live()) return make_learned_segmenter(std::move(*network), std::move(*detector), options.clean_up);
  Result<BackgroundSamples> samples = sample(video, {}, progress);
  if (!samples) return samples.failure();
  return make_learned_segmenter(std::move(*network), std::move(*detector), options.clean_up, *samples);
}

Result<std::unique_ptr<Segmenter>> make_chroma(Video& video, const SegmenterOptions& options, ProgressSink* progress) {
  if (video.is_live()) {
    return error("{}: the screen is learned from the whole clip, which a live camera has not", video.name());
  }
  const Result<BackgroundSamples> samples = sample(video, {}, progress);
  if (!samples) return samples.failure();
  Result<ScreenModel> model = learn_screen(*samples, options.key_colour, options.clean_up.garbage_mask);
  if (!model) return error("{}: {}", video.name(), model.error().message);
  return make_chroma_segmenter(std::move(*model), video.name(), options.clean_up);
}

Result<std::unique_ptr<Segmenter>> make_depth(const Video& video, const SegmenterOptions& options,
                                              ProgressSink* progress) {
  if (options.depth.empty()) return error("segmenter 'depth': no depth images are given");
  Result<DepthFiles> depth = open_depth(options, video);
  if (!depth) return depth.failure();
  return make_depth_segmenter(std::move(*depth), options.depth_range, options.clean_up, progress);
}

Result<std::string> chosen_kind(Video& video, const SegmenterOptions& options) {
  if (options.kind != "auto") return options.kind;
  if (!options.masks.empty()) return std::string("masks");
  if (options.background) return std::string("background");
  if (!video.is_live()) {
    if (Result<void> rewound = video.rewind(); !rewound) return rewound.failure();
    const Result<bool> masks = shows_masks(video);
    if (!masks) return masks.failure();
    if (*masks) return std::string("masks");
  }
  return std::string(has_person_networks(options.networks) ? "learned" : "background");
}

}  // namespace

Result<std::unique_ptr<Segmenter>> make_segmenter(Video& video, const SegmenterOptions& options,
                                                  ProgressSink* progress) {
  check(video.num_cameras() == 1, "make_segmenter: {} cameras", video.num_cameras());
  options.clean_up.check();
  if (const auto fits = check_sizes(video, options.clean_up); !fits) return fits.failure();
  const Result<std::string> chosen = chosen_kind(video, options);
  if (!chosen) return chosen.failure();
  const std::string& kind = *chosen;
  if (kind == "masks") return make_masks(video, options);
  if (kind == "learned") return make_learned(video, options, progress);
  if (kind == "background") return make_background(video, options, progress);
  if (kind == "chroma") return make_chroma(video, options, progress);
  if (kind == "depth") return make_depth(video, options, progress);
  return error("segmenter '{}': unknown; known are auto, background, chroma, depth, learned, masks", kind);
}

}  // namespace silpose
