#include "silpose/likelihood/depth_likelihood.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/shape/distance.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

constexpr double kMetres = 1e-3;  // [definition] of a DepthImage's unit

// What a window's pixels show of the subject. `depth` is 0 outside the mask and where nothing is known. `unknown`:
// pixels that are ignored, and those of the mask without depth; empty: none.
struct Seen {
  Image<float> depth;
  std::vector<bool> unknown;
};

Seen seen_in(const Observation& observation, const Window& window) {
  Seen seen{Image<float>(window.width, window.height), {}};
  std::vector<bool> unknown(seen.depth.pixels().size());
  const Mask& mask = observation.mask;
  for (int y = 0; y < window.height; ++y) {
    const int image_y = std::min(static_cast<int>(window.y0 + (y + 0.5) / window.scale_y), mask.height() - 1);
    for (int x = 0; x < window.width; ++x) {
      const int image_x = std::min(static_cast<int>(window.x0 + (x + 0.5) / window.scale_x), mask.width() - 1);
      const bool is_ignored = observation.ignored && observation.ignored->get(image_x, image_y);
      const uint16_t measured = observation.depth->at(image_x, image_y);
      const bool is_hole = mask.get(image_x, image_y) && measured == 0;
      unknown[static_cast<size_t>(y * window.width + x)] = is_ignored || is_hole;
      if (mask.get(image_x, image_y) && !is_ignored) seen.depth.at(x, y) = static_cast<float>(kMetres * measured);
    }
  }
  if (std::ranges::count(unknown, true) > 0) seen.unknown = std::move(unknown);
  return seen;
}

// By drawing: for backends that do not compare depths themselves, and where pixels are unknown.
void distances_of_images(const RenderBackend& backend, const BatchView& poses, const Window& window, const Seen& seen,
                         double missing_m, std::span<double> out) {
  Image<float> image(window.width, window.height);
  for (size_t n = 0; n < poses.num_poses; ++n) {
    backend.depths({poses.data + n * poses.stride, 1, poses.num_dofs, poses.stride}, window, image.pixels());
    for (size_t i = 0; i < seen.unknown.size(); ++i) {
      if (seen.unknown[i]) image.pixels()[i] = 0;
    }
    out[n] = depth_ssd(image, seen.depth, missing_m);
  }
}

}  // namespace

struct DepthLikelihood::Prepared final : Evidence {
  struct View {
    double trust = 0;  // 0: this camera is ignored
    Window window;
    Seen seen;
    double num_pixels = 0;
  };
  std::vector<View> views;  // [C]
};

void DepthOptions::check() const {
  silpose::check(std::isfinite(sharpness) && sharpness > 0, "sharpness {} is not a positive number", sharpness);
  silpose::check(std::isfinite(missing_m) && missing_m > 0, "missing depth: {} m is not a positive number", missing_m);
  silpose::check(resolution >= 16 && resolution <= 1024, "resolution {} is not within 16..1024", resolution);
}

DepthLikelihood::DepthLikelihood(std::vector<std::shared_ptr<const RenderBackend>> backends, DepthOptions options)
    : backends_(std::move(backends)), options_(options) {
  options_.check();
  check(!backends_.empty(), "DepthLikelihood: no backend");
  for (const auto& backend : backends_) {
    check(&backend->body() == &body(), "DepthLikelihood: backends of different bodies");
  }
}

std::unique_ptr<const PoseLikelihood::Evidence> DepthLikelihood::prepare(
    std::span<const Observation> observations) const {
  check(observations.size() == backends_.size(), "DepthLikelihood: {} observations for {} cameras", observations.size(),
        backends_.size());
  auto prepared = std::make_unique<Prepared>();
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& observation = observations[c];
    const PinholeCamera& camera = backends_[c]->camera();
    Prepared::View& view = prepared->views.emplace_back();
    check_fits(observation, camera);
    const Box box = observation.box();
    if (!observation.depth || observation.trust.nothing_found || box.empty()) continue;
    const double scale = std::min(1.0, options_.resolution / static_cast<double>(std::max(box.width, box.height)));
    view.window = window_of_image(camera.width, camera.height, scale);
    view.seen = seen_in(observation, view.window);
    view.num_pixels =
        static_cast<double>(std::ranges::count_if(view.seen.depth.pixels(), [](float depth) { return depth > 0; }));
    view.trust = view.num_pixels > 0 ? observation.trust.overall : 0;
  }
  return prepared;
}

void DepthLikelihood::add_log_likelihood(const Evidence& evidence, const StateBatch& states,
                                         std::span<double> out) const {
  check_batch(body(), states, out);
  const auto& views = own_evidence<Prepared>(evidence).views;
  const BatchView poses{states.data(), out.size(), static_cast<size_t>(body().skeleton.num_dofs()),
                        static_cast<size_t>(states.cols())};
  check(views.size() == backends_.size(), "DepthLikelihood: evidence of {} cameras for {}", views.size(),
        backends_.size());
  std::vector<double> distances(out.size());
  for (size_t c = 0; c < views.size(); ++c) {
    const Prepared::View& view = views[c];
    if (view.trust <= 0) continue;
    if (!view.seen.unknown.empty() ||
        !backends_[c]->depth_distances(poses, view.window, view.seen.depth, options_.missing_m, distances)) {
      distances_of_images(*backends_[c], poses, view.window, view.seen, options_.missing_m, distances);
    }
    const double scale = options_.sharpness * view.trust / (view.num_pixels * options_.missing_m * options_.missing_m);
    for (size_t n = 0; n < out.size(); ++n) out[n] -= scale * distances[n];
  }
}

}  // namespace silpose
