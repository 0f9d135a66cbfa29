#include "silpose/likelihood/coverage_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/body/point_motion.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

// Where an edge of a triangle crosses a row.
struct Crossing {
  double x = 0, dx_dy = 0, t = 0;  // (1 - t) * vertex a + t * vertex b
  uint32_t vertex_a = 0, vertex_b = 0;
};
struct Interval {
  Crossing left, right;
};

// [rows] the union of what the triangles cover of each row first + r * step.
std::vector<std::vector<Interval>> cover_rows(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                                              double first, double step, int count) {
  std::vector<std::vector<Interval>> rows(static_cast<size_t>(count));
  for (const Face& face : faces) {
    if (std::ranges::any_of(face, [&](uint32_t v) { return std::isnan(pixels[v].x()); })) continue;
    for (int r = 0; r < count; ++r) {
      const double y = first + r * step;
      std::vector<Crossing> crossings;
      for (size_t side = 0; side < 3; ++side) {
        uint32_t a = face[side], b = face[(side + 1) % 3];
        if (pixels[b].y() < pixels[a].y()) std::swap(a, b);
        const Eigen::Vector2d top = pixels[a].cast<double>(), bottom = pixels[b].cast<double>();
        if (!(top.y() <= y && y < bottom.y())) continue;
        const double dx_dy = (bottom.x() - top.x()) / (bottom.y() - top.y());
        crossings.push_back({top.x() + dx_dy * (y - top.y()), dx_dy, (y - top.y()) / (bottom.y() - top.y()), a, b});
      }
      if (crossings.empty()) continue;
      check(crossings.size() == 2, "a triangle crosses a row {} times", crossings.size());
      if (crossings[1].x < crossings[0].x) std::swap(crossings[0], crossings[1]);
      rows[static_cast<size_t>(r)].push_back({crossings[0], crossings[1]});
    }
  }
  for (std::vector<Interval>& row : rows) {
    std::ranges::sort(row, {}, [](const Interval& interval) { return interval.left.x; });
    std::vector<Interval> united;
    for (const Interval& interval : row) {
      if (united.empty() || interval.left.x > united.back().right.x) {
        united.push_back(interval);
      } else if (interval.right.x > united.back().right.x) {
        united.back().right = interval.right;
      }
    }
    row = std::move(united);
  }
  return rows;
}

// d x / d pose [D] of a crossing: its vertices move, and the edge slides through the row.
Eigen::VectorXd motion_of(const Crossing& crossing, const BodyModel& body, const PinholeCamera& camera,
                          const PointMotion& motion) {
  Eigen::VectorXd derivative = Eigen::VectorXd::Zero(body.skeleton.num_dofs());
  for (const auto& [vertex, part] :
       {std::pair(crossing.vertex_a, 1 - crossing.t), std::pair(crossing.vertex_b, crossing.t)}) {
    const uint32_t begin = body.skin.row_start[vertex], end = body.skin.row_start[vertex + 1];
    const auto placed_by = [&](uint32_t i) {
      const auto j = static_cast<size_t>(body.skin.joint_idx[i]);
      return Eigen::Vector3d(motion.world_from_joint()[j] *
                             (body.joint_from_rest[j] * body.rest.vertices[vertex].cast<double>()));
    };
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (uint32_t i = begin; i < end; ++i) x += static_cast<double>(body.skin.weight[i]) * placed_by(i);
    const Eigen::Matrix<double, 2, 3> pixel = camera.project_jacobian(x);
    const Eigen::Vector3d direction = (pixel.row(0) - crossing.dx_dy * pixel.row(1)).transpose();
    for (uint32_t i = begin; i < end; ++i) {
      const Eigen::Vector3d pull = part * static_cast<double>(body.skin.weight[i]) * direction;
      motion.add_derivative(body.skin.joint_idx[i], placed_by(i), pull, derivative);
    }
  }
  return derivative;
}

// G * G at a distance of whole cells, cut off as CoverageDifference does.
double kernel(int d) {
  constexpr int kRadius = 4;  // [definition] kBlurRadius
  if (std::abs(d) > kRadius) return 0;
  double sum = 0;
  for (int i = -kRadius; i <= kRadius; ++i) sum += std::exp(-i * i / 4.0);
  return std::exp(-d * d / 4.0) / sum;
}

struct CellDerivative {
  int x = 0, y = 0;
  Eigen::VectorXd row;  // [D]
};

// Model minus observed coverage of each cell, and its derivative.
struct Difference {
  Image<double> value;                   // [h, w]
  std::vector<CellDerivative> jacobian;  // of cells that hold an end of an interval

  // The derivative of cell (x, y), which becomes 0 where it was not there.
  Eigen::VectorXd& derivative_of(int x, int y, Eigen::Index num_dofs) {
    auto of_cell = std::ranges::find_if(jacobian, [&](const auto& other) { return other.x == x && other.y == y; });
    if (of_cell == jacobian.end()) of_cell = jacobian.insert(of_cell, {x, y, Eigen::VectorXd::Zero(num_dofs)});
    return of_cell->row;
  }
};

Difference compare(const BodyModel& body, const PinholeCamera& camera, const CoverageEvidence::Raster& raster,
                   std::span<const double> pose, int rows_per_cell) {
  const double cell = raster.cell, step = cell / rows_per_cell;
  const auto vertices = skin_vertices(body, pose);
  std::vector<Eigen::Vector2f> pixels(vertices.size());
  project_vertices(camera, vertices, pixels);
  const auto rows =
      cover_rows(pixels, body.rest.faces, step / 2, step, static_cast<int>(std::floor(camera.height / step)));

  Difference difference{Image<double>(raster.width, raster.height), {}};
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      difference.value.at(x, y) = -static_cast<double>(raster.observed[raster.at(x, y)]);
    }
  }
  const PointMotion motion(body.skeleton, pose);
  for (size_t r = 0; r < rows.size(); ++r) {
    const int y = static_cast<int>(r) / rows_per_cell;
    for (const Interval& interval : rows[r]) {
      const double begin = std::max(interval.left.x, 0.0), end = std::min<double>(interval.right.x, camera.width);
      if (!(begin < end)) continue;
      for (int x = 0; x < raster.width; ++x) {
        difference.value.at(x, y) +=
            std::max(0.0, std::min(end, (x + 1) * cell) - std::max(begin, x * cell)) / cell / rows_per_cell;
      }
      const auto add_end = [&](const Crossing& at, double by) {
        const int x = std::min(static_cast<int>(at.x / cell), raster.width - 1);
        difference.derivative_of(x, y, body.skeleton.num_dofs()) +=
            by / cell / rows_per_cell * motion_of(at, body, camera, motion);
      };
      if (interval.left.x > 0) add_end(interval.left, -1);
      if (interval.right.x < camera.width) add_end(interval.right, 1);
    }
  }
  return difference;
}

void weigh_by_confidence(const CoverageEvidence::Raster& raster, Difference& difference) {
  if (raster.confidence.empty()) return;
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      difference.value.at(x, y) *= static_cast<double>(raster.confidence[raster.at(x, y)]);
    }
  }
  for (CellDerivative& derivative : difference.jacobian) {
    derivative.row *= static_cast<double>(raster.confidence[raster.at(derivative.x, derivative.y)]);
  }
}

// The difference of a cell after the blur, on both sides.
double blurred(const Image<double>& difference, int cell_x, int cell_y) {
  double sum = 0;
  for (int y = std::max(0, cell_y - 4); y <= std::min(difference.height() - 1, cell_y + 4); ++y) {
    for (int x = std::max(0, cell_x - 4); x <= std::min(difference.width() - 1, cell_x + 4); ++x) {
      sum += kernel(x - cell_x) * kernel(y - cell_y) * difference.at(x, y);
    }
  }
  return sum;
}

void add_view(const BodyModel& body, const PinholeCamera& camera, const CoverageEvidence::Raster& raster, double weight,
              std::span<const double> pose, int rows_per_cell, NormalEquations& equations) {
  Difference difference = compare(body, camera, raster, pose, rows_per_cell);
  weigh_by_confidence(raster, difference);
  const Image<double>& value = difference.value;
  for (int y = 0; y < value.height(); ++y) {
    for (int x = 0; x < value.width(); ++x) {
      if (value.at(x, y) != 0) equations.energy += weight * value.at(x, y) * blurred(value, x, y);
    }
  }
  for (const CellDerivative& one : difference.jacobian) {
    equations.gradient += weight * blurred(value, one.x, one.y) * one.row;
    Eigen::VectorXd near = Eigen::VectorXd::Zero(one.row.size());
    for (const CellDerivative& other : difference.jacobian) {
      near += kernel(one.x - other.x) * kernel(one.y - other.y) * other.row;
    }
    equations.hessian += weight * one.row * near.transpose();
  }
}

}  // namespace

NormalEquations linearise_reference(const BodyModel& body, std::span<const PinholeCamera> cameras,
                                    const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                    int rows_per_cell) {
  check(evidence.views.size() == cameras.size(), "linearise_reference: evidence of {} cameras for {}",
        evidence.views.size(), cameras.size());
  const Eigen::Index D = body.skeleton.num_dofs();
  NormalEquations equations{0, Eigen::VectorXd::Zero(D), Eigen::MatrixXd::Zero(D, D)};
  for (size_t c = 0; c < cameras.size(); ++c) {
    const CoverageEvidence::View& view = evidence.views[c];
    if (view.trust <= 0) continue;
    const CoverageEvidence::Raster& raster = view.rasters[static_cast<size_t>(blur)];
    const double scale = 2 * std::sqrt(std::numbers::pi) * std::pow(raster.cell, 3);
    add_view(body, cameras[c], raster, view.trust / evidence.noise[c] * scale, pose, rows_per_cell, equations);
  }
  return equations;
}

}  // namespace silpose
