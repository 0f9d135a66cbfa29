// The cells of CoverageLikelihood: how much of each an observation covers, and the difference to a drawn body, blurred,
// with its derivative.
// Threads: pure functions; a CoverageDifference belongs to one thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

// REQUIRES: cell > 0.
CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell);

// D = w (C_model - C_observed) on the cells, K = G * G the blur applied twice, sigma one cell.
class CoverageDifference {
 public:
  // Forgets everything. `num_dofs` 0: no derivative will be asked for.
  void start(const CoverageEvidence::Raster& raster, int rows_per_cell, int num_dofs = 0);

  // Adds the model's span [begin, end) (pixels inside the picture) of one sampled row of a row of cells.
  void add_span(int cell_y, float begin, float end);
  [[nodiscard]] int column_of(float x) const { return std::min(static_cast<int>(x * per_cell_), width_ - 1); }

  // d C_model / d pose of a cell grows by `derivative` [D].
  void add_derivative(int cell_x, int cell_y, std::span<const float> derivative);

  // After all was added: subtracts the observation, and gives D' K D.
  double finish();

  // After finish(): gradient += weight * J' K D, hessian += weight * J' K J, J = d D / d pose.
  void add_normal_equations(double weight, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian);

 private:
  static constexpr int kRadius = 4;  // cells: beyond, exp(-d^2 / 4) is below 0.2 % of the peak
  using Row = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  void blur(int x0, int x1, int y0, int y1);

  const CoverageEvidence::Raster* raster_ = nullptr;
  int width_ = 0, height_ = 0, num_dofs_ = 0;
  float per_cell_ = 1, row_weight_ = 1;
  std::vector<float> difference_, half_blurred_, blurred_;         // [height, width] cells
  std::vector<int32_t> end_of_cell_;                               // [height, width] row of jacobian_, or -1
  std::vector<int32_t> end_cells_;                                 // cells that hold an end
  Row jacobian_, near_;                                            // [ends, D]
  int model_x0_ = 0, model_x1_ = 0, model_y0_ = 0, model_y1_ = 0;  // cells the model touches
  int drawn_x0_ = 0, drawn_x1_ = 0, drawn_y0_ = 0, drawn_y1_ = 0;  // cells that are not zero
};

}  // namespace silpose
