#include "silpose/render/depth_renderer.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/scratch_pool.h"
#include "silpose/render/pose_projector.h"
#include "silpose/render/triangle_fill.h"

namespace silpose {
namespace {

// What one thread draws a pose with. Only `drawn` of the raster is not 0.
class DepthScratch {
 public:
  PoseProjector::Scratch projected;
  std::vector<float> inverse_depth;  // [points]
  std::vector<float> nearness;       // [height, width] 1 / depth; 0 where there is nothing
  int width = 0, height = 0;
  struct Box {
    int x_begin, y_begin, x_end, y_end;
  };
  Box drawn = {};
  std::vector<uint32_t> candidates;  // [faces] scratch

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

  // Triangles are smaller than pixels most of the time, and most hold no pixel's centre: these are sorted out first,
  // without branches, which could not be predicted.
  void draw(std::span<const Face> faces) {
    if (candidates.size() < faces.size()) candidates.resize(faces.size());
    size_t num_candidates = 0;
    for (uint32_t f = 0; f < faces.size(); ++f) {
      const Box box = box_of(faces[f]);
      candidates[num_candidates] = f;
      num_candidates += static_cast<size_t>((box.x_begin < box.x_end) & (box.y_begin < box.y_end));
    }
    for (size_t i = 0; i < num_candidates; ++i) draw(faces[candidates[i]]);
  }

 private:
  // Whose centres a triangle may hold: those on its right and bottom are outside.
  [[nodiscard]] Box box_of(const Face& face) const {
    const std::span<const GridPoint> points = projected.points();
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    return {std::max(0, first_centre_from(std::min(a.x, std::min(b.x, c.x)))),
            std::max(0, first_centre_from(std::min(a.y, std::min(b.y, c.y)))),
            std::min(width, first_centre_from(std::max(a.x, std::max(b.x, c.x)))),
            std::min(height, first_centre_from(std::max(a.y, std::max(b.y, c.y))))};
  }

  // The pixels of fill_triangle().
  void draw(const Face& face) {
    const std::span<const GridPoint> points = projected.points();
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (a.unseen() || b.unseen() || c.unseen()) return;
    const auto [x_begin, y_begin, x_end, y_end] = box_of(face);
    const int64_t area = side_of_edge(a, b, c);
    if (area == 0) return;
    const int64_t turn = area > 0 ? 1 : -1;
    const std::array<Side, 3> sides = {Side(b, c, turn, x_begin, y_begin), Side(c, a, turn, x_begin, y_begin),
                                       Side(a, b, turn, x_begin, y_begin)};
    const double per_area = 1 / static_cast<double>(area * turn);
    const double near_a = inverse_depth[face[0]] * per_area, near_b = inverse_depth[face[1]] * per_area,
                 near_c = inverse_depth[face[2]] * per_area;
    for (int y = y_begin; y < y_end; ++y) {
      int64_t of_a = sides[0].at_row(y - y_begin), of_b = sides[1].at_row(y - y_begin),
              of_c = sides[2].at_row(y - y_begin);
      float* const nearest = row(y);
      for (int x = x_begin; x < x_end; ++x) {
        if (((of_a - sides[0].least) | (of_b - sides[1].least) | (of_c - sides[2].least)) >= 0) {
          const double nearness_here = static_cast<double>(of_a) * near_a + static_cast<double>(of_b) * near_b +
                                       static_cast<double>(of_c) * near_c;
          nearest[x] = std::max(nearest[x], static_cast<float>(nearness_here));
        }
        of_a += sides[0].by_x;
        of_b += sides[1].by_x;
        of_c += sides[2].by_x;
      }
    }
    drawn = {std::min(drawn.x_begin, x_begin), std::min(drawn.y_begin, y_begin), std::max(drawn.x_end, x_end),
             std::max(drawn.y_end, y_end)};
  }

  // On which side of an edge centres of pixels lie, as side_of_edge(), from one pixel to the next.
  struct Side {
    Side(GridPoint from, GridPoint to, int64_t turn, int x, int y)
        : first(turn *
                side_of_edge(from, to, {x * kGridPerPixel + kGridHalfPixel, y * kGridPerPixel + kGridHalfPixel})),
          by_x(-turn * (to.y - from.y) * kGridPerPixel),
          by_y(turn * (to.x - from.x) * kGridPerPixel),
          least(by_x > 0 || (by_x == 0 && by_y > 0) ? 0 : 1) {}
    [[nodiscard]] int64_t at_row(int rows_below) const { return first + rows_below * by_y; }
    int64_t first, by_x, by_y;
    int64_t least;  // inside; edges on the left or at the top are
  };
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
          scratch->draw(projector.faces());
          scratch->draw(scratch->projected.cut_faces());
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
