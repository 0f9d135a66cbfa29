#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/render/coverage_count.h"
#include "silpose/render/outline_scan.h"
#include "silpose/render/projected_mesh.h"
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
  // Only where some of the body is too near to be seen, which is rare: the reference's vertices, by slot.
  ProjectedMesh cut;
  std::vector<Eigen::Vector3f> vertices_in_world;
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

  // project(pose, scratch) leaves a pose's points on the grid of the window that it returns, or nothing when it is not
  // seen; count(outline) tells what is wanted of the outline scanned there.
  template <class Project, class Count>
  void counts(const BatchView& poses, std::span<OutlineRenderer::Counts> out, const Project& project,
              const Count& count) const {
    check(out.size() == poses.num_poses, "BatchRenderer: {} poses, room for {}", poses.num_poses, out.size());
    check(poses.num_dofs == static_cast<size_t>(body->skeleton.num_dofs()), "BatchRenderer: poses of {} DOF for {}",
          poses.num_dofs, body->skeleton.num_dofs());
    constexpr size_t kGrain = 32;
    parallel_for(poses.num_poses, kGrain, [&](size_t begin, size_t end) {
      std::unique_ptr<PoseScratch> scratch = pool.take(topology);
      for (size_t n = begin; n < end; ++n) {
        out[n] = {};
        const std::span pose(poses.data + n * poses.stride, poses.num_dofs);
        if (const std::optional<Window> window = project(pose, *scratch)) {
          scan(*window, *scratch);
          out[n] = count(scratch->outline);
        }
      }
      pool.give_back(std::move(scratch));
    });
  }

  // Where some of the body is too near to be seen: its faces cut, in pixels.
  void cut(std::span<const double> pose, PoseScratch& scratch) const {
    const std::vector<Eigen::Vector3f> vertices = skin_vertices(*body, pose);
    scratch.vertices_in_world.clear();
    for (const uint32_t vertex : skin.vertex_of_slot()) scratch.vertices_in_world.push_back(vertices[vertex]);
    project_mesh(camera, scratch.vertices_in_world, skin.faces(), scratch.cut);
  }

  bool project(std::span<const double> pose, PoseScratch& scratch) const {
    if (!skin.project(pose, scratch.projected)) return false;
    if (!scratch.projected.some_unseen) return true;
    cut(pose, scratch);
    const auto bounds = pixel_bounds(scratch.cut.pixels);
    scratch.projected.bounds = bounds.value_or(PixelBounds{});
    return bounds.has_value();
  }

  void round(const Window& window, PoseScratch& scratch) const {
    if (!scratch.projected.some_unseen) {
      skin.round(window, scratch.projected);
      return;
    }
    scratch.projected.points.resize(scratch.cut.pixels.size());
    round_to_grid(scratch.cut.pixels, window, scratch.projected.points);
  }

  std::optional<Window> project_to(const Window& window, std::span<const double> pose, PoseScratch& scratch) const {
    if (!skin.project_to_grid(pose, window, scratch.projected)) return std::nullopt;
    if (scratch.projected.some_unseen) {
      cut(pose, scratch);
      round(window, scratch);
    }
    return window;
  }

  // To the window of the part inside the picture, of samples where `finer`.
  std::optional<Window> project_cropped(int width, int height, bool finer, std::span<const double> pose,
                                        PoseScratch& scratch) const {
    if (!project(pose, scratch)) return std::nullopt;
    const auto bounds = bounds_in_picture(scratch);
    if (!bounds) return std::nullopt;
    const Window cropped = window_of(*bounds, width, height);
    const Window window = finer ? sample_window(cropped) : cropped;
    round(window, scratch);
    return window;
  }

  static void scan(const Window& window, PoseScratch& scratch) {
    const bool some_unseen = scratch.projected.some_unseen;
    scratch.outline.scan(scratch.projected.points, some_unseen, window.width, window.height,
                         some_unseen ? std::span<const Face>(scratch.cut.cut_faces) : std::span<const Face>());
  }

  // Bounds of the part inside the picture. Only a body cut by the picture's border needs drawing for it.
  std::optional<PixelBounds> bounds_in_picture(PoseScratch& scratch) const {
    const PixelBounds& bounds = scratch.projected.bounds;
    if (bounds.x0 >= 0 && bounds.y0 >= 0 && bounds.x1 <= camera.width && bounds.y1 <= camera.height) return bounds;
    const Window picture{.width = camera.width, .height = camera.height};
    round(picture, scratch);
    scan(picture, scratch);
    return scratch.outline.bounds();
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

const BodyModel& BatchRenderer::body() const { return *impl_->body; }
const PinholeCamera& BatchRenderer::camera() const { return impl_->camera; }

}  // namespace silpose
