#include "silpose/likelihood/silhouette_likelihood.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

constexpr double kMostPixels = 1 << 29;  // [definition] of a raster on which silhouettes are drawn
// [guess] Of the silhouettes that are drawn at a time for metrics that look at them: memory that a laptop has.
constexpr size_t kMostBytes = 64 << 20;

}  // namespace

// What one camera saw; no description: it is not used.
struct SilhouetteLikelihood::View {
  double trust = 0;
  Window window;
  std::unique_ptr<const ShapeMetric::Description> observed;
};

struct SilhouetteLikelihood::Prepared final : Evidence {
  std::vector<View> views;  // [C]
};

void SilhouetteOptions::check() const {
  silpose::check(std::isfinite(sharpness) && sharpness > 0, "sharpness {} is not a positive number", sharpness);
  silpose::check(resolution >= 16 && resolution <= 1024, "resolution {} is not within 16..1024", resolution);
}

SilhouetteLikelihood::SilhouetteLikelihood(std::vector<std::shared_ptr<const RenderBackend>> backends,
                                           std::shared_ptr<const ShapeMetric> metric, SilhouetteOptions options)
    : backends_(std::move(backends)), metric_(std::move(metric)), options_(options) {
  options_.check();
  check(!backends_.empty(), "SilhouetteLikelihood: no backend");
  check(metric_ != nullptr, "SilhouetteLikelihood: no metric");
  for (const auto& backend : backends_) {
    check(&backend->body() == &body(), "SilhouetteLikelihood: backends of different bodies");
  }
}

Window SilhouetteLikelihood::window_of_comparison(const Box& box, const PinholeCamera& camera) const {
  if (options_.comparison == Comparison::kCropped) return window_of(box, options_.resolution, options_.resolution);
  // Never enlarged: there is nothing to see between the pixels of a small subject.
  const double longer_side = std::max({box.width, box.height, 1});
  const Window raster_of_pixel = metric_->raster({.width = 1, .height = 1});
  const double pixels =
      static_cast<double>(raster_of_pixel.width) * raster_of_pixel.height * camera.width * camera.height;
  const double scale = std::min({1.0, options_.resolution / longer_side, std::sqrt(kMostPixels / pixels)});
  return window_of_image(camera.width, camera.height, scale);
}

SilhouetteLikelihood::View SilhouetteLikelihood::view_of(const Observation& observation,
                                                         const PinholeCamera& camera) const {
  const Box box = observation.box();
  if (observation.trust.nothing_found || box.empty()) return {};
  View view{.trust = observation.trust.overall, .window = window_of_comparison(box, camera)};
  const Mask* ignored = options_.comparison == Comparison::kImage ? observation.ignored.get() : nullptr;
  if (ignored != nullptr && observation.known(observation.mask).count() == 0) return {};
  view.observed = metric_->describe(observation.mask, ignored, view.window);
  if (view.observed->is_empty()) return {};
  return view;
}

std::unique_ptr<const PoseLikelihood::Evidence> SilhouetteLikelihood::prepare(
    std::span<const Observation> observations) const {
  check_number(observations, backends_.size());
  auto prepared = std::make_unique<Prepared>();
  for (size_t c = 0; c < observations.size(); ++c) {
    check_fits(observations[c], backends_[c]->camera());
    prepared->views.push_back(view_of(observations[c], backends_[c]->camera()));
  }
  return prepared;
}

// By counting while drawing; false where the metric or the backend cannot.
bool SilhouetteLikelihood::count(size_t camera_idx, const View& view, const BatchView& poses,
                                 std::span<double> out) const {
  const auto* metric = dynamic_cast<const AreaMetric*>(metric_.get());
  if (metric == nullptr) return false;
  const auto& observed = dynamic_cast<const AreaMetric::Described&>(*view.observed);
  const Framing framing{view.window, options_.comparison == Comparison::kCropped};
  const auto count_against = [&](const Mask& mask, const ByteImage& coverage,
                                 std::vector<OutlineRenderer::Counts>& counts) {
    return coverage.empty() ? backends_[camera_idx]->counts(poses, framing, mask, counts)
                            : backends_[camera_idx]->coverages(poses, framing, coverage, counts);
  };
  std::vector<OutlineRenderer::Counts> counts(out.size());
  if (!count_against(observed.mask, observed.coverage, counts)) return false;
  if (observed.has_ignored()) {
    std::vector<OutlineRenderer::Counts> unseen(out.size());
    check(count_against(observed.ignored, observed.ignored_coverage, unseen),
          "SilhouetteLikelihood: a backend that counts only sometimes");
    for (size_t n = 0; n < out.size(); ++n) counts[n].model -= unseen[n].both;
  }
  for (size_t n = 0; n < out.size(); ++n) {
    out[n] = metric->distance({observed.area, counts[n].model, counts[n].both});
  }
  return true;
}

void SilhouetteLikelihood::distances_of(size_t camera_idx, const View& view, const BatchView& poses,
                                        std::span<double> out) const {
  if (count(camera_idx, view, poses, out)) return;
  const Framing framing{metric_->raster(view.window), options_.comparison == Comparison::kCropped};
  const size_t bytes = static_cast<size_t>(framing.window.width) * static_cast<size_t>(framing.window.height) / 8 + 1;
  const size_t most = std::max<size_t>(1, kMostBytes / bytes);
  std::vector<Mask> masks;
  for (size_t begin = 0; begin < poses.num_poses; begin += most) {
    const size_t num = std::min(most, poses.num_poses - begin);
    masks.resize(num);
    backends_[camera_idx]->silhouettes({poses.data + begin * poses.stride, num, poses.num_dofs, poses.stride}, framing,
                                       masks);
    metric_->distances(*view.observed, masks, out.subspan(begin, num));
  }
}

void SilhouetteLikelihood::accumulate(const Prepared& evidence, const StateBatch& states, bool weighted,
                                      std::span<double> out) const {
  check_batch(body(), states, out);
  check(evidence.views.size() == backends_.size(), "SilhouetteLikelihood: evidence of {} cameras for {}",
        evidence.views.size(), backends_.size());
  std::ranges::fill(out, 0.0);
  const BatchView poses{states.data(), out.size(), static_cast<size_t>(body().skeleton.num_dofs()),
                        static_cast<size_t>(states.cols())};
  std::vector<double> distances(out.size());
  for (size_t c = 0; c < backends_.size(); ++c) {
    const View& view = evidence.views[c];
    if (view.trust <= 0) continue;
    distances_of(c, view, poses, distances);
    for (size_t n = 0; n < out.size(); ++n) out[n] += (weighted ? view.trust : 1.0) * distances[n];
  }
}

void SilhouetteLikelihood::distances(const Evidence& evidence, const StateBatch& states, std::span<double> out) const {
  const auto& prepared = own_evidence<Prepared>(evidence);
  accumulate(prepared, states, false, out);
  const auto seen = std::ranges::count_if(prepared.views, [](const View& view) { return view.trust > 0; });
  for (double& distance : out) distance = seen > 0 ? distance / static_cast<double>(seen) : 0;
}

void SilhouetteLikelihood::add_log_likelihood(const Evidence& evidence, const StateBatch& states,
                                              std::span<double> out) const {
  std::vector<double> sums(out.size());
  accumulate(own_evidence<Prepared>(evidence), states, true, sums);
  for (size_t n = 0; n < out.size(); ++n) out[n] += -options_.sharpness * sums[n];
}

}  // namespace silpose
