#include "silpose/render/depth_renderer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/render/pose_projector.h"
#include "silpose/render/triangle_fill.h"

namespace silpose {
namespace {

// What one thread draws a pose with. Only `drawn` of the raster is not 0.
struct DepthScratch {
  PoseProjector::Scratch projected;
  std::vector<float> inverse_depth;  // [points]
  std::vector<float> nearness;       // [height, width] 1 / depth; 0 where there is nothing
  int width = 0, height = 0;
  struct {
    int x_begin, y_begin, x_end, y_end;
  } drawn = {};

  void start(const Window& window) {
    if (width != window.width || height != window.height) {
      width = window.width;
      height = window.height;
      nearness.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0);
    } else {
      for (int y = drawn.y_begin; y < drawn.y_end; ++y) std::fill(row(y) + drawn.x_begin, row(y) + drawn.x_end, 0.0f);
    }
    drawn = {width, height, 0, 0};
  }
  [[nodiscard]] float* row(int y) { return nearness.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }

  void draw(const Face& face) {
    const std::span<const GridPoint> points = projected.points();
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (a.unseen() || b.unseen() || c.unseen()) return;
    const double near_a = inverse_depth[face[0]], near_b = inverse_depth[face[1]], near_c = inverse_depth[face[2]];
    fill_triangle(a, b, c, width, height, [&](int x, int y, int64_t wa, int64_t wb, int64_t wc) {
      const double sum =
          static_cast<double>(wa) * near_a + static_cast<double>(wb) * near_b + static_cast<double>(wc) * near_c;
      float& nearest = row(y)[x];
      nearest = std::max(nearest, static_cast<float>(sum / static_cast<double>(wa + wb + wc)));
      drawn = {std::min(drawn.x_begin, x), std::min(drawn.y_begin, y), std::max(drawn.x_end, x + 1),
               std::max(drawn.y_end, y + 1)};
    });
  }
};

}  // namespace

struct DepthRenderer::Impl {
  Impl(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera) : projector(std::move(body), camera) {}

  // take(n, scratch) gets every pose as it was drawn.
  template <class Take>
  void draw(const BatchView& poses, const Window& window, const Take& take) const {
    const int num_dofs = projector.body().skeleton.num_dofs();
    check(poses.num_dofs == static_cast<size_t>(num_dofs), "DepthRenderer: poses of {} DOF for {}", poses.num_dofs,
          num_dofs);
    constexpr size_t kGrain = 8;
    parallel_for(poses.num_poses, kGrain, [&](size_t begin, size_t end) {
      std::unique_ptr<DepthScratch> scratch = pool.take();
      for (size_t n = begin; n < end; ++n) {
        scratch->start(window);
        if (projector.project({poses.data + n * poses.stride, poses.num_dofs}, scratch->projected)) {
          projector.round(window, scratch->projected);
          projector.inverse_depths(scratch->projected, scratch->inverse_depth);
          for (const Face& face : projector.faces()) scratch->draw(face);
          for (const Face& face : scratch->projected.cut_faces()) scratch->draw(face);
        }
        take(n, *scratch);
      }
      pool.give_back(std::move(scratch));
    });
  }

  PoseProjector projector;
  mutable ScratchPool<DepthScratch> pool;
};

DepthRenderer::DepthRenderer(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera) {
  check(body != nullptr && !body->rest.faces.empty(), "DepthRenderer: no body");
  impl_ = std::make_shared<const Impl>(std::move(body), camera);
}

void DepthRenderer::images(const BatchView& poses, const Window& window, std::span<float> out) const {
  const size_t size = static_cast<size_t>(window.width) * static_cast<size_t>(window.height);
  check(out.size() == poses.num_poses * size, "DepthRenderer: {} images of {}x{}, room for {} pixels", poses.num_poses,
        window.width, window.height, out.size());
  impl_->draw(poses, window, [&](size_t n, const DepthScratch& scratch) {
    std::ranges::transform(scratch.nearness, out.begin() + static_cast<std::ptrdiff_t>(n * size),
                           [](float nearness) { return nearness == 0 ? 0.0f : 1 / nearness; });
  });
}

void DepthRenderer::distances(const BatchView& poses, const Window& window, const Image<float>& observed,
                              double missing_m, std::span<double> out) const {
  check(observed.width() == window.width && observed.height() == window.height && observed.channels() == 1,
        "DepthRenderer: depth image of {}x{}x{} for a window of {}x{}", observed.width(), observed.height(),
        observed.channels(), window.width, window.height);
  check(out.size() == poses.num_poses, "DepthRenderer: {} poses, room for {}", poses.num_poses, out.size());
  const double missing = missing_m * missing_m;
  const auto num_observed = std::ranges::count_if(observed.pixels(), [](float depth) { return depth != 0; });
  impl_->draw(poses, window, [&](size_t n, DepthScratch& scratch) {
    // Where nothing is drawn all that was observed is missing; only the drawn part need be looked at.
    double sum = 0;
    int64_t num_missing = num_observed;
    for (int y = scratch.drawn.y_begin; y < scratch.drawn.y_end; ++y) {
      const float* const nearness = scratch.row(y);
      const std::span<const float> depths = observed.row(y);
      for (int x = scratch.drawn.x_begin; x < scratch.drawn.x_end; ++x) {
        if (nearness[x] == 0) continue;
        const double depth = depths[static_cast<size_t>(x)];
        const double difference = 1.0 / nearness[x] - depth;
        sum += depth == 0 ? 0 : difference * difference;
        num_missing += depth == 0 ? 1 : -1;
      }
    }
    out[n] = sum + missing * static_cast<double>(num_missing);
  });
}

const BodyModel& DepthRenderer::body() const { return impl_->projector.body(); }
const PinholeCamera& DepthRenderer::camera() const { return impl_->projector.camera(); }

}  // namespace silpose
