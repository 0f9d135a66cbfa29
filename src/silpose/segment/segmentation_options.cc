#include "silpose/segment/segmentation_options.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>

#include "silpose/base/option_error.h"
#include "silpose/image/image_file.h"

namespace silpose {
namespace {

constexpr std::array<std::string_view, 6> kKinds = {"auto", "background", "chroma", "depth", "learned", "masks"};

// One value for all cameras, or one per camera; empty where none is given.
std::string of_camera(const char* option, const std::vector<std::string>& values, size_t camera, size_t num_cameras) {
  if (values.empty()) return "";
  if (values.size() == 1) return values[0];
  if (values.size() != num_cameras) {
    throw_option_error("{}: given {} times for {} videos", option, values.size(), num_cameras);
  }
  return values[camera];
}

Box parse_region(const std::string& text) {
  const OptionInfo pixels = {.name = {}, .kind = OptionKind::kNumber, .low = -1e6, .high = 1e6};
  std::vector<int> numbers;
  std::istringstream words(text);
  bool fits = !text.empty() && text.back() != ',';
  for (std::string word; fits && std::getline(words, word, ',');) {
    const Result<OptionValue> number = parse_option(pixels, word);
    fits = number.ok() && std::get<double>(*number) == std::floor(std::get<double>(*number));
    if (fits) numbers.push_back(static_cast<int>(std::get<double>(*number)));
  }
  if (!fits || numbers.size() != 4 || numbers[2] < 1 || numbers[3] < 1) {
    throw_option_error("--region: {} is not x,y,w,h in whole pixels", text);
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::optional<KeyColour> key_colour_of(const std::string& text) {
  const auto key = parse_key_colour(text);
  if (!key) throw_option_error("--key-colour: {}", key.error().message);
  return *key;
}

std::optional<DepthRange> depth_range_of(const std::optional<std::array<double, 2>>& range_m) {
  if (!range_m) return {};
  const auto [nearest, farthest] = *range_m;
  if (!(nearest < farthest)) throw_option_error("--depth-range: {},{} is not MIN,MAX", nearest, farthest);
  return DepthRange{nearest, farthest};
}

Result<CleanUpOptions> clean_up_options(const SegmentationOptions& options, const Video& video, size_t camera) {
  const auto count = static_cast<size_t>(video.num_cameras());
  CleanUpOptions clean_up;
  clean_up.grow_px = options.grow_px;
  if (options.min_blob_px) clean_up.min_blob_px = *options.min_blob_px;
  const std::string region = of_camera("--region", options.regions, camera, count);
  if (!region.empty()) clean_up.region = parse_region(region);
  const std::string garbage = of_camera("--garbage-mask", options.garbage_masks, camera, count);
  if (!garbage.empty()) {
    Result<Mask> mask = read_mask(garbage);
    if (!mask) return mask.failure();
    const int width = video.width(static_cast<int>(camera)), height = video.height(static_cast<int>(camera));
    if (mask->width() != width || mask->height() != height) {
      return error("{}: {}x{}, but the video is {}x{}", garbage, mask->width(), mask->height(), width, height);
    }
    clean_up.garbage_mask = std::move(*mask);
  }
  return clean_up;
}

Result<SegmenterOptions> options_of_camera(const SegmentationOptions& options, const Video& video, size_t camera) {
  const auto count = static_cast<size_t>(video.num_cameras());
  SegmenterOptions segmenter;
  segmenter.kind = options.segmenter;
  const std::string background = of_camera("--background", options.backgrounds, camera, count);
  if (!background.empty()) {
    Result<BackgroundOrigin> origin = background_origin_of(background);
    if (!origin) return origin.failure();
    segmenter.background = std::move(*origin);
  }
  segmenter.masks = of_camera("--masks", options.masks, camera, count);
  segmenter.key_colour = key_colour_of(options.key_colour);
  segmenter.depth = of_camera("--depth", options.depths, camera, count);
  segmenter.depth_range = depth_range_of(options.depth_range_m);
  Result<CleanUpOptions> clean_up = clean_up_options(options, video, camera);
  if (!clean_up) return clean_up.failure();
  segmenter.clean_up = std::move(*clean_up);
  return segmenter;
}

}  // namespace

const OptionTable<SegmentationOptions>& segmentation_option_table() {
  using S = SegmentationOptions;
  static const OptionTable<S> kTable = {
      "The segmenter",
      {{"segmenter", &S::segmenter, words_from(kKinds),
        "How the person is cut out: masks (given), background, learned (by a network), chroma, depth, or auto: the "
        "first of masks and background that is requested, otherwise learned if scripts/fetch-network-data has run"},
       {"background", &S::backgrounds,
        "auto (from the whole clip), online, lead-in:SECONDS, or a video or image of the empty scene"},
       {"key-colour", &S::key_colour,
        "With chroma: the screen's, as #00b140; auto: the commonest saturated colour of the clip"},
       {"depth", &S::depths,
        "With depth, and with background to add to its colours: a folder or pattern of 16-bit images in mm, one per "
        "frame, once per camera"},
       {"depth-range", &S::depth_range_m, between(0, 65.535),
        "MIN,MAX in metres: what lies between is the person; without, what is in front of the scene"},
       {"masks", &S::masks, "Masks made elsewhere: a folder, a pattern or a video, once per camera"},
       {"region", &S::regions,
        "x,y,w,h in pixels: a blob counts only if at least half of it lies inside; it is not cut"},
       {"garbage-mask", &S::garbage_masks,
        "An image: what is not white in it is removed from the mask and does not count"},
       {"grow", &S::grow_px, between(-64, 64), "Grows the mask by this many pixels; negative shrinks"},
       {"min-blob", &S::min_blob_px, between(0, 100'000'000),
        "Pixels below which a blob does not count (0.05 % of the image)"}}};
  return kTable;
}

void SegmentationOptions::check() const {
  const auto belongs = [&](const char* option, bool given, const char* kind) {
    if (given && segmenter != kind) throw_option_error("{}: needs --segmenter {}", option, kind);
  };
  belongs("--key-colour", key_colour != "auto", "chroma");
  if (!depths.empty() && segmenter != "depth" && segmenter != "background") {
    throw_option_error("--depth: needs --segmenter depth or background");
  }
  belongs("--depth-range", depth_range_m.has_value(), "depth");
  if (segmenter == "depth" && depths.empty()) throw_option_error("--segmenter depth: needs --depth");
  (void)key_colour_of(key_colour);
  (void)depth_range_of(depth_range_m);
  for (const std::string& region : regions) (void)parse_region(region);
}

Result<std::vector<SegmenterOptions>> segmenter_options(const SegmentationOptions& options, const Video& video,
                                                        const std::filesystem::path& networks) {
  options.check();
  std::vector<SegmenterOptions> segmenters;
  for (size_t camera = 0; camera < static_cast<size_t>(video.num_cameras()); ++camera) {
    Result<SegmenterOptions> segmenter = options_of_camera(options, video, camera);
    if (!segmenter) return segmenter.failure();
    segmenter->networks = networks.string();
    segmenters.push_back(std::move(*segmenter));
  }
  return segmenters;
}

}  // namespace silpose
