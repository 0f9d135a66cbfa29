// CoverageDifference: how much a rendered body covers of each cell, minus what an observation covers, blurred, with its
// derivative. Only cells that the body or the observation touch are worked on, and rows of the Jacobian exist only for
// cells that hold an end.
// Threads: an object belongs to one thread.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/base/aligned_floats.h"
#include "silpose/likelihood/coverage_evidence.h"
#include "silpose/likelihood/coverage_kernels.h"
#include "silpose/likelihood/jacobian_kernels.h"
#include "silpose/render/span_kernels.h"

namespace silpose {

// D = w (C_model - C_observed) on the cells, K = G * G the blur applied twice, sigma one cell.
class CoverageDifference {
 public:
  // Forgets everything. `image_width` in pixels: what is outside covers nothing.
  void start(const CoverageEvidence::Raster& raster, int image_width, int rows_per_cell);

  // Adds what the model covers, once: the ends of its spans on sampled rows, rows_per_cell to a cell.
  void add_model(const SpanEnds& ends);

  // After add_model(): numbers the cells that hold ends, row by row, and says in which each end lies; -1: outside of
  // the image, where it moves nothing. [ends]
  std::span<const int32_t> number_cells();
  [[nodiscard]] size_t num_end_cells() const { return num_end_cells_; }
  [[nodiscard]] float confidence(size_t end_cell) const {
    return raster_->confidence.empty() ? 1.0f : raster_->confidence[raster_->at(end_x_[end_cell], end_y_[end_cell])];
  }

  // J = d D / d pose, for the caller to fill: rows [cells that hold ends, stride], and for each the blocks of kLanes
  // columns where it is not zero. REQUIRES: stride a multiple of AlignedFloats::kLanes.
  struct Jacobian {
    float* rows;
    int32_t* blocks;
  };
  Jacobian jacobian(size_t stride);

  // After add_model(): subtracts the observation, and gives D' K D.
  double finish();

  // After finish(), with the Jacobian filled: gradient += weight * J' K D, hessian += weight * J' K J, where the
  // derivative by DOF d is in column `columns`[d] of J.
  void add_normal_equations(double weight, std::span<const uint32_t> columns, Eigen::VectorXd& gradient,
                            Eigen::MatrixXd& hessian);

 private:
  static constexpr int kMargin = AlignedFloats::kLanes;  // cells beyond the image that stay zero
  static size_t stride_of(int length) {
    return AlignedFloats::padded(static_cast<size_t>(length)) + 3 * static_cast<size_t>(kMargin);
  }
  [[nodiscard]] size_t at(int cell_x, int cell_y) const {
    return static_cast<size_t>(cell_x) * stride_ + static_cast<size_t>(cell_y + kMargin);
  }
  [[nodiscard]] size_t rank_at(int cell_x, int cell_y) const {
    return static_cast<size_t>(cell_y) * rank_stride_ + static_cast<size_t>(cell_x + kMargin);
  }

  const CoverageEvidence::Raster* raster_ = nullptr;
  int width_ = 0, height_ = 0;
  size_t stride_ = 0, rank_stride_ = 0;
  float image_width_ = 0;
  int rows_per_cell_ = 1;
  // Column by column: [width + 1, stride_], the last unread. Before finish(): how much coverage changes from the left.
  std::vector<float> difference_;
  AlignedFloats half_blurred_, blurred_;  // of the drawn box
  CellBox model_, drawn_;                 // cells that the model touches, and the observation
  // [ends]
  size_t num_ends_ = 0;
  std::vector<int32_t> end_cell_x_, end_cell_y_, end_at_, number_;
  std::vector<float> end_here_, end_beyond_;
  // Cells that hold an end: bits [height, words_], how many come before each cell [height, rank_stride_], a list.
  size_t words_ = 0;
  std::vector<uint64_t> holds_end_;
  std::vector<int32_t> rank_, end_x_, end_y_;
  size_t num_end_cells_ = 0, jacobian_stride_ = 0;
  AlignedFloats jacobian_, half_near_, product_;
  std::vector<int32_t> blocks_, near_blocks_;
  std::vector<uint64_t> bits_, near_bits_;
  std::vector<float> blurred_at_ends_;
};

}  // namespace silpose
