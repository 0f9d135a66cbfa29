#include "silpose/base/check.h"
#include "silpose/render/coverage_count.h"
#include "silpose/render/outline_scan.h"
#include "silpose/render/silhouette.h"

namespace silpose {

struct OutlineRenderer::Scratch {
  explicit Scratch(const EdgeTopology& topology) : outline(topology) {}
  OutlineScan outline;
  std::vector<GridPoint> points;
};

OutlineRenderer::OutlineRenderer(const EdgeTopology& topology) : scratch_(std::make_unique<Scratch>(topology)) {}
OutlineRenderer::OutlineRenderer(OutlineRenderer&&) noexcept = default;
OutlineRenderer::~OutlineRenderer() = default;

void OutlineRenderer::scan(std::span<const Eigen::Vector2f> pixels, const Window& window,
                           std::span<const Face> cut_faces) {
  scratch_->points.resize(pixels.size());
  const bool some_unseen = round_to_grid(pixels, window, scratch_->points);
  scratch_->outline.scan(scratch_->points, some_unseen, window.width, window.height, cut_faces);
}

void OutlineRenderer::draw(std::span<const Eigen::Vector2f> pixels, const Window& window, Mask& mask,
                           std::span<const Face> cut_faces) {
  if (mask.width() == window.width && mask.height() == window.height) {
    mask.clear();
  } else {
    mask = Mask(window.width, window.height);
  }
  scan(pixels, window, cut_faces);
  scratch_->outline.draw(mask);
}

OutlineRenderer::Counts OutlineRenderer::count(std::span<const Eigen::Vector2f> pixels, const Window& window,
                                               const Mask& observed, std::span<const Face> cut_faces) {
  check(observed.width() == window.width && observed.height() == window.height,
        "OutlineRenderer: mask of {}x{} for a window of {}x{}", observed.width(), observed.height(), window.width,
        window.height);
  scan(pixels, window, cut_faces);
  return scratch_->outline.count(observed);
}

OutlineRenderer::Counts OutlineRenderer::count_coverage(std::span<const Eigen::Vector2f> pixels, const Window& window,
                                                        const ByteImage& observed, std::span<const Face> cut_faces) {
  const CoverageColumns columns(observed);
  scan(pixels, sample_window(window), cut_faces);
  return columns.count(scratch_->outline.bits());
}

}  // namespace silpose
