#include "silpose/render/render_backend.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/render/depth_renderer.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/render/shaded.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

void check_size(const Framing& framing, int width, int height) {
  check(width == framing.window.width && height == framing.window.height,
        "RenderBackend: {}x{} observed for a window of {}x{}", width, height, framing.window.width,
        framing.window.height);
}

class CpuBackend final : public RenderBackend {
 public:
  CpuBackend(const std::shared_ptr<const BodyModel>& body, const PinholeCamera& camera)
      : silhouettes_(body, camera), depths_(body, camera) {}

  const BodyModel& body() const override { return silhouettes_.body(); }
  const PinholeCamera& camera() const override { return silhouettes_.camera(); }

  void silhouettes(const BatchView& poses, const Framing& framing, std::span<Mask> out) const override {
    if (framing.cropped) {
      silhouettes_.silhouettes_cropped(poses, framing.window.width, framing.window.height, out);
    } else {
      silhouettes_.silhouettes(poses, framing.window, out);
    }
  }
  void depths(const BatchView& poses, const Window& window, std::span<float> out) const override {
    depths_.images(poses, window, out);
  }
  bool counts(const BatchView& poses, const Framing& framing, const Mask& observed,
              std::span<OutlineRenderer::Counts> out) const override {
    check_size(framing, observed.width(), observed.height());
    if (framing.cropped) {
      silhouettes_.counts_cropped(poses, observed, out);
    } else {
      silhouettes_.counts(poses, framing.window, observed, out);
    }
    return true;
  }
  bool coverages(const BatchView& poses, const Framing& framing, const ByteImage& observed,
                 std::span<OutlineRenderer::Counts> out) const override {
    check_size(framing, observed.width(), observed.height());
    if (framing.cropped) {
      silhouettes_.coverages_cropped(poses, observed, out);
    } else {
      silhouettes_.coverages(poses, framing.window, observed, out);
    }
    return true;
  }
  bool depth_distances(const BatchView& poses, const Window& window, const Image<float>& observed, double missing_m,
                       std::span<double> out) const override {
    depths_.distances(poses, window, observed, missing_m, out);
    return true;
  }

 private:
  BatchRenderer silhouettes_;
  DepthRenderer depths_;
};

class ReferenceBackend final : public RenderBackend {
 public:
  ReferenceBackend(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera)
      : body_(std::move(body)), camera_(camera) {
    check(body_ != nullptr && !body_->rest.faces.empty(), "ReferenceBackend: no body");
  }

  const BodyModel& body() const override { return *body_; }
  const PinholeCamera& camera() const override { return camera_; }

  void silhouettes(const BatchView& poses, const Framing& framing, std::span<Mask> out) const override {
    check(out.size() == poses.num_poses, "ReferenceBackend: {} poses, room for {}", poses.num_poses, out.size());
    for (size_t n = 0; n < poses.num_poses; ++n) {
      const std::optional<std::vector<Eigen::Vector3f>> vertices = vertices_of(poses, n);
      out[n] = Mask(framing.window.width, framing.window.height);
      if (!vertices) continue;
      ProjectedMesh mesh;
      project_mesh(camera_, *vertices, body_->rest.faces, mesh);
      const std::optional<Window> window = framing.cropped ? cropped(mesh, framing.window) : framing.window;
      if (window) draw_silhouette_reference(mesh.pixels, body_->rest.faces, *window, out[n], mesh.cut_faces);
    }
  }

  void depths(const BatchView& poses, const Window& window, std::span<float> out) const override {
    const size_t size = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
    check(out.size() == poses.num_poses * size, "ReferenceBackend: {} poses of {} pixels, room for {}", poses.num_poses,
          size, out.size());
    std::ranges::fill(out, 0.0f);
    for (size_t n = 0; n < poses.num_poses; ++n) {
      const std::optional<std::vector<Eigen::Vector3f>> vertices = vertices_of(poses, n);
      if (!vertices) continue;
      const Image<float> depth = draw_depth(camera_, *vertices, body_->rest.faces, window);
      std::ranges::copy(depth.pixels(), out.begin() + static_cast<std::ptrdiff_t>(n * size));
    }
  }

 private:
  // Nothing for a pose with a number that is not finite.
  std::optional<std::vector<Eigen::Vector3f>> vertices_of(const BatchView& poses, size_t n) const {
    const auto num_dofs = static_cast<size_t>(body_->skeleton.num_dofs());
    check(poses.num_dofs == num_dofs, "ReferenceBackend: poses of {} DOF for {}", poses.num_dofs, num_dofs);
    const std::span pose(poses.data + n * poses.stride, poses.num_dofs);
    if (!std::ranges::all_of(pose, [](double x) { return std::isfinite(x); })) return std::nullopt;
    return skin_vertices(*body_, pose);
  }

  // The window of the part inside the image.
  std::optional<Window> cropped(const ProjectedMesh& mesh, const Window& raster) const {
    const std::optional<PixelBounds> bounds = pixel_bounds(mesh.pixels);
    if (!bounds) return std::nullopt;
    if (bounds->x0 >= 0 && bounds->y0 >= 0 && bounds->x1 <= camera_.width && bounds->y1 <= camera_.height) {
      return window_of(*bounds, raster.width, raster.height);
    }
    Mask whole;
    const Window image{.width = camera_.width, .height = camera_.height};
    draw_silhouette_reference(mesh.pixels, body_->rest.faces, image, whole, mesh.cut_faces);
    const Box box = whole.bounding_box();
    if (box.empty()) return std::nullopt;
    return window_of(box, raster.width, raster.height);
  }

  std::shared_ptr<const BodyModel> body_;
  PinholeCamera camera_;
};

}  // namespace

bool RenderBackend::counts(const BatchView&, const Framing&, const Mask&, std::span<OutlineRenderer::Counts>) const {
  return false;
}
bool RenderBackend::coverages(const BatchView&, const Framing&, const ByteImage&,
                              std::span<OutlineRenderer::Counts>) const {
  return false;
}
bool RenderBackend::depth_distances(const BatchView&, const Window&, const Image<float>&, double,
                                    std::span<double>) const {
  return false;
}

std::shared_ptr<const RenderBackend> make_cpu_backend(std::shared_ptr<const BodyModel> body,
                                                      const PinholeCamera& camera) {
  return std::make_shared<const CpuBackend>(body, camera);
}

std::shared_ptr<const RenderBackend> make_reference_backend(std::shared_ptr<const BodyModel> body,
                                                            const PinholeCamera& camera) {
  return std::make_shared<const ReferenceBackend>(std::move(body), camera);
}

}  // namespace silpose
