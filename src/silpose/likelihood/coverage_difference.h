// CoverageDifference: how much a drawn body covers of each cell, less what an observation covers, blurred, with its
// derivative. Only cells that the body or the observation touch are worked on, and rows of the Jacobian exist only for
// cells that hold an end.
// Threads: an object belongs to one thread.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "silpose/base/aligned_floats.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

// D = w (C_model - C_observed) on the cells, K = G * G the blur applied twice, sigma one cell.
class CoverageDifference {
 public:
  // Forgets everything.
  void start(const CoverageEvidence::Raster& raster, int rows_per_cell);

  // Adds the model's span [begin, end) (pixels inside the picture) of one sampled row of a row of cells.
  void add_span(int cell_y, float begin, float end);
  [[nodiscard]] int column_of(float x) const { return std::min(static_cast<int>(x * per_cell_), width_ - 1); }

  // A cell that a span touches holds an end, whose derivative will follow.
  void mark_end(int cell_x, int cell_y) { rank_[at(cell_x, cell_y)] = 1; }
  // After all spans and ends: how many cells hold ends. They are numbered row by row.
  size_t number_cells();
  [[nodiscard]] int32_t number_of(int cell_x, int cell_y) const { return rank_[at(cell_x, cell_y)]; }
  [[nodiscard]] float confidence(int cell_x, int cell_y) const {
    return raster_->confidence.empty() ? 1.0f : raster_->confidence.at(cell_x, cell_y);
  }

  // J = d D / d pose [cells that hold ends, stride], for the caller to fill: D columns, then at least one of zeros.
  // REQUIRES: stride a multiple of AlignedFloats::kLanes.
  float* jacobian(size_t stride);

  // After all spans: subtracts the observation, and gives D' K D.
  double finish();

  // After finish(), with the Jacobian filled: gradient += weight * J' K D, hessian += weight * J' K J.
  void add_normal_equations(double weight, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian);

 private:
  static constexpr int kMargin = AlignedFloats::kLanes;  // cells left and right of the picture that stay zero
  static size_t stride_of(int width) {
    return AlignedFloats::padded(static_cast<size_t>(width)) + 3 * static_cast<size_t>(kMargin);
  }
  [[nodiscard]] size_t at(int cell_x, int cell_y) const {
    return static_cast<size_t>(cell_y) * stride_ + static_cast<size_t>(cell_x + kMargin);
  }

  const CoverageEvidence::Raster* raster_ = nullptr;
  int width_ = 0, height_ = 0;
  size_t stride_ = 0;
  float per_cell_ = 1, row_weight_ = 1;
  std::vector<float> difference_;         // [height, stride_] cells
  AlignedFloats half_blurred_, blurred_;  // of the drawn box
  std::vector<int32_t> rank_;             // [height, stride_] 1: holds ends; then number_of()
  std::vector<int32_t> end_x_, end_y_;    // cells that hold an end
  size_t num_end_cells_ = 0, jacobian_stride_ = 0;
  AlignedFloats jacobian_, half_near_, product_;
  int model_x0_ = 0, model_x1_ = 0, model_y0_ = 0, model_y1_ = 0;  // cells the model touches
  int drawn_x0_ = 0, drawn_x1_ = 0, drawn_y0_ = 0, drawn_y1_ = 0;  // cells that are not zero
};

}  // namespace silpose
