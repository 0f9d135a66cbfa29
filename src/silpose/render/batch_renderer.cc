#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/scratch_pool.h"
#include "silpose/render/coverage_count.h"
#include "silpose/render/outline_scan.h"
#include "silpose/render/pose_projector.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

// What one thread draws a pose with.
struct PoseScratch {
  explicit PoseScratch(const EdgeTopology& topology) : outline(topology) {}
  PoseProjector::Scratch projected;
  OutlineScan outline;
};

}  // namespace

struct BatchRenderer::Impl {
  Impl(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera)
      : projector(std::move(body), camera), topology(projector.faces()) {}

  // project(pose, scratch) leaves a pose's points on the grid of the window that it returns, or nothing when it is not
  // seen; take(n, outline) takes what is wanted of the outline scanned there.
  template <class Project, class Take>
  void for_each_seen(const BatchView& poses, const Project& project, const Take& take) const {
    const int num_dofs = projector.body().skeleton.num_dofs();
    check(poses.num_dofs == static_cast<size_t>(num_dofs), "BatchRenderer: poses of {} DOF for {}", poses.num_dofs,
          num_dofs);
    constexpr size_t kGrain = 32;
    parallel_for(poses.num_poses, kGrain, [&](size_t begin, size_t end) {
      std::unique_ptr<PoseScratch> scratch = pool.take(topology);
      for (size_t n = begin; n < end; ++n) {
        const std::span pose(poses.data + n * poses.stride, poses.num_dofs);
        if (const std::optional<Window> window = project(pose, *scratch)) {
          scan(*window, *scratch);
          take(n, scratch->outline);
        }
      }
      pool.give_back(std::move(scratch));
    });
  }

  template <class Project, class Count>
  void counts(const BatchView& poses, std::span<OutlineRenderer::Counts> out, const Project& project,
              const Count& count) const {
    check(out.size() == poses.num_poses, "BatchRenderer: {} poses, room for {}", poses.num_poses, out.size());
    std::ranges::fill(out, OutlineRenderer::Counts{});
    for_each_seen(poses, project, [&](size_t n, const OutlineScan& outline) { out[n] = count(outline); });
  }

  std::optional<Window> project_to(const Window& window, std::span<const double> pose, PoseScratch& scratch) const {
    if (!projector.project_to_grid(pose, window, scratch.projected)) return std::nullopt;
    return window;
  }

  // To the window of the part inside the image, of samples where `finer`.
  std::optional<Window> project_cropped(int width, int height, bool finer, std::span<const double> pose,
                                        PoseScratch& scratch) const {
    if (!projector.project(pose, scratch.projected)) return std::nullopt;
    const auto bounds = bounds_in_image(scratch);
    if (!bounds) return std::nullopt;
    const Window cropped = window_of(*bounds, width, height);
    const Window window = finer ? sample_window(cropped) : cropped;
    projector.round(window, scratch.projected);
    return window;
  }

  static void scan(const Window& window, PoseScratch& scratch) {
    const PoseProjector::Scratch& projected = scratch.projected;
    scratch.outline.scan(projected.points(), projected.some_unseen(), window.width, window.height,
                         projected.cut_faces());
  }

  // Bounds of the part inside the image. Only a body cut by the image's border needs drawing for it.
  std::optional<PixelBounds> bounds_in_image(PoseScratch& scratch) const {
    const PixelBounds& bounds = scratch.projected.bounds();
    const PinholeCamera& camera = projector.camera();
    if (bounds.x0 >= 0 && bounds.y0 >= 0 && bounds.x1 <= camera.width && bounds.y1 <= camera.height) return bounds;
    const Window image{.width = camera.width, .height = camera.height};
    projector.round(image, scratch.projected);
    scan(image, scratch);
    return scratch.outline.bounds();
  }

  PoseProjector projector;
  EdgeTopology topology;
  mutable ScratchPool<PoseScratch> pool;
};

BatchRenderer::BatchRenderer(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera) {
  check(body != nullptr && !body->rest.faces.empty(), "BatchRenderer: no body");
  impl_ = std::make_shared<const Impl>(std::move(body), camera);
}

void BatchRenderer::counts(const BatchView& poses, const Window& window, const Mask& observed,
                           std::span<OutlineRenderer::Counts> out) const {
  check(observed.width() == window.width && observed.height() == window.height,
        "BatchRenderer: mask of {}x{} for a window of {}x{}", observed.width(), observed.height(), window.width,
        window.height);
  impl_->counts(
      poses, out, [&](auto pose, auto& scratch) { return impl_->project_to(window, pose, scratch); },
      [&](const OutlineScan& outline) { return outline.count(observed); });
}

void BatchRenderer::coverages(const BatchView& poses, const Window& window, const ByteImage& observed,
                              std::span<OutlineRenderer::Counts> out) const {
  check(observed.width() == window.width && observed.height() == window.height,
        "BatchRenderer: coverage of {}x{} for a window of {}x{}", observed.width(), observed.height(), window.width,
        window.height);
  const CoverageColumns columns(observed);
  const Window samples = sample_window(window);
  impl_->counts(
      poses, out, [&](auto pose, auto& scratch) { return impl_->project_to(samples, pose, scratch); },
      [&](const OutlineScan& outline) { return columns.count(outline.bits()); });
}

void BatchRenderer::counts_cropped(const BatchView& poses, const Mask& observed_cropped,
                                   std::span<OutlineRenderer::Counts> out) const {
  const int width = observed_cropped.width(), height = observed_cropped.height();
  impl_->counts(
      poses, out, [&](auto pose, auto& scratch) { return impl_->project_cropped(width, height, false, pose, scratch); },
      [&](const OutlineScan& outline) { return outline.count(observed_cropped); });
}

void BatchRenderer::coverages_cropped(const BatchView& poses, const ByteImage& observed_cropped,
                                      std::span<OutlineRenderer::Counts> out) const {
  const int width = observed_cropped.width(), height = observed_cropped.height();
  const CoverageColumns columns(observed_cropped);
  impl_->counts(
      poses, out, [&](auto pose, auto& scratch) { return impl_->project_cropped(width, height, true, pose, scratch); },
      [&](const OutlineScan& outline) { return columns.count(outline.bits()); });
}

void BatchRenderer::silhouettes(const BatchView& poses, const Window& window, std::span<Mask> out) const {
  check(out.size() == poses.num_poses, "BatchRenderer: {} poses, room for {}", poses.num_poses, out.size());
  std::ranges::fill(out, Mask(window.width, window.height));
  impl_->for_each_seen(
      poses, [&](auto pose, auto& scratch) { return impl_->project_to(window, pose, scratch); },
      [&](size_t n, const OutlineScan& outline) { outline.draw(out[n]); });
}

void BatchRenderer::silhouettes_cropped(const BatchView& poses, int width, int height, std::span<Mask> out) const {
  check(out.size() == poses.num_poses, "BatchRenderer: {} poses, room for {}", poses.num_poses, out.size());
  std::ranges::fill(out, Mask(width, height));
  impl_->for_each_seen(
      poses, [&](auto pose, auto& scratch) { return impl_->project_cropped(width, height, false, pose, scratch); },
      [&](size_t n, const OutlineScan& outline) { outline.draw(out[n]); });
}

Mask BatchRenderer::silhouette(std::span<const double> pose) const {
  Mask mask;
  const Window image{.width = camera().width, .height = camera().height};
  silhouettes({pose.data(), 1, pose.size(), pose.size()}, image, {&mask, 1});
  return mask;
}

const BodyModel& BatchRenderer::body() const { return impl_->projector.body(); }
const PinholeCamera& BatchRenderer::camera() const { return impl_->projector.camera(); }

}  // namespace silpose
