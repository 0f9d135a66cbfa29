#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/render/outline_scan.h"
#include "silpose/render/projected_skin.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

// What one thread draws a pose with.
struct PoseScratch {
  explicit PoseScratch(const EdgeTopology& topology) : outline(topology) {}
  ProjectedSkin::Scratch projected;
  OutlineScan outline;
};

// Keeps scratch from one range of poses to the next, so that nothing is allocated once every thread has had its own.
class ScratchPool {
 public:
  [[nodiscard]] std::unique_ptr<PoseScratch> take(const EdgeTopology& topology) {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<PoseScratch> scratch = std::move(free_.back());
        free_.pop_back();
        return scratch;
      }
    }
    return std::make_unique<PoseScratch>(topology);
  }
  void give_back(std::unique_ptr<PoseScratch> scratch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<PoseScratch>> free_;
};

}  // namespace

struct BatchRenderer::Impl {
  Impl(std::shared_ptr<const BodyModel> the_body, PinholeCamera the_camera)
      : body(std::move(the_body)), camera(std::move(the_camera)), skin(*body, camera), topology(skin.faces()) {}

  // project(pose, projected, outline) leaves a pose's points on the grid of the window that it returns, or nothing when
  // it is not seen.
  template <class Project>
  void counts(const BatchView& poses, const Mask& observed, std::span<OutlineRenderer::Counts> out,
              const Project& project) const {
    check(out.size() == poses.num_poses, "BatchRenderer: {} poses, room for {}", poses.num_poses, out.size());
    check(poses.num_dofs == static_cast<size_t>(body->skeleton.num_dofs()), "BatchRenderer: poses of {} DOF for {}",
          poses.num_dofs, body->skeleton.num_dofs());
    constexpr size_t kGrain = 32;
    parallel_for(poses.num_poses, kGrain, [&](size_t begin, size_t end) {
      std::unique_ptr<PoseScratch> scratch = pool.take(topology);
      auto& [projected, outline] = *scratch;
      for (size_t n = begin; n < end; ++n) {
        out[n] = {};
        const std::span pose(poses.data + n * poses.stride, poses.num_dofs);
        if (const std::optional<Window> window = project(pose, projected, outline)) {
          outline.scan(projected.points, projected.some_unseen, window->width, window->height);
          out[n] = outline.count(observed);
        }
      }
      pool.give_back(std::move(scratch));
    });
  }

  // Bounds of the part inside the picture. Only a body cut by the picture's border needs drawing for it.
  std::optional<PixelBounds> bounds_in_picture(ProjectedSkin::Scratch& projected, OutlineScan& outline) const {
    const PixelBounds& bounds = projected.bounds;
    if (bounds.x0 >= 0 && bounds.y0 >= 0 && bounds.x1 <= camera.width && bounds.y1 <= camera.height) return bounds;
    skin.round({.width = camera.width, .height = camera.height}, projected);
    outline.scan(projected.points, projected.some_unseen, camera.width, camera.height);
    return outline.bounds();
  }

  std::shared_ptr<const BodyModel> body;
  PinholeCamera camera;
  ProjectedSkin skin;
  EdgeTopology topology;
  mutable ScratchPool pool;
};

BatchRenderer::BatchRenderer(std::shared_ptr<const BodyModel> body, PinholeCamera camera) {
  check(body != nullptr && !body->rest.faces.empty(), "BatchRenderer: no body");
  impl_ = std::make_shared<const Impl>(std::move(body), std::move(camera));
}

void BatchRenderer::counts(const BatchView& poses, const Window& window, const Mask& observed,
                           std::span<OutlineRenderer::Counts> out) const {
  check(observed.width() == window.width && observed.height() == window.height,
        "BatchRenderer: mask of {}x{} for a window of {}x{}", observed.width(), observed.height(), window.width,
        window.height);
  impl_->counts(poses, observed, out, [&](auto pose, auto& projected, auto&) -> std::optional<Window> {
    if (!impl_->skin.project_to_grid(pose, window, projected)) return std::nullopt;
    return window;
  });
}

void BatchRenderer::counts_cropped(const BatchView& poses, const Mask& observed_cropped,
                                   std::span<OutlineRenderer::Counts> out) const {
  impl_->counts(poses, observed_cropped, out, [&](auto pose, auto& projected, auto& outline) -> std::optional<Window> {
    if (!impl_->skin.project(pose, projected)) return std::nullopt;
    const auto bounds = impl_->bounds_in_picture(projected, outline);
    if (!bounds) return std::nullopt;
    const Window window = window_of(*bounds, observed_cropped.width(), observed_cropped.height());
    impl_->skin.round(window, projected);
    return window;
  });
}

const BodyModel& BatchRenderer::body() const { return *impl_->body; }
const PinholeCamera& BatchRenderer::camera() const { return impl_->camera; }

}  // namespace silpose
