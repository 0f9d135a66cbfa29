#include "silpose/likelihood/coverage_raster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// A Gaussian of sigma sqrt(2) cells, at 0, 1, ... cells; sums to 1 over both sides.
std::array<float, 5> make_kernel() {
  std::array<double, 5> weight{};
  double sum = 0;
  for (size_t d = 0; d < weight.size(); ++d) {
    weight[d] = std::exp(-static_cast<double>(d * d) / 4);
    sum += d == 0 ? weight[d] : 2 * weight[d];
  }
  std::array<float, 5> kernel{};
  for (size_t d = 0; d < weight.size(); ++d) kernel[d] = static_cast<float>(weight[d] / sum);
  return kernel;
}
const std::array<float, 5> kKernel = make_kernel();

int cells_along(int pixels, int cell) { return (pixels + cell - 1) / cell; }

}  // namespace

CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell) {
  check(cell > 0, "coverage_raster: cells of {} pixels", cell);
  const Mask& mask = observation.mask;
  CoverageEvidence::Raster raster;
  raster.cell = cell;
  const int width = cells_along(mask.width(), cell), height = cells_along(mask.height(), cell);
  raster.observed = Image<float>(width, height);
  const float one_pixel = 1.0f / static_cast<float>(cell * cell);
  for (int y = observation.box.y; y < observation.box.y + observation.box.height; ++y) {
    const auto words = mask.row(y);
    const auto cells = raster.observed.row(y / cell);
    for (size_t w = 0; w < words.size(); ++w) {
      for (uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
        cells[static_cast<size_t>((static_cast<int>(64 * w) + std::countr_zero(bits)) / cell)] += one_pixel;
      }
    }
  }
  const Box& box = observation.box;
  raster.occupied = {box.x / cell, box.y / cell, (box.x + box.width - 1) / cell - box.x / cell + 1,
                     (box.y + box.height - 1) / cell - box.y / cell + 1};
  if (!observation.confidence.empty()) {
    check(observation.confidence.width() == mask.width() && observation.confidence.height() == mask.height(),
          "coverage_raster: confidence of {}x{} for a mask of {}x{}", observation.confidence.width(),
          observation.confidence.height(), mask.width(), mask.height());
    raster.confidence = Image<float>(width, height);
    for (int y = 0; y < mask.height(); ++y) {
      const auto row = observation.confidence.row(y);
      const auto cells = raster.confidence.row(y / cell);
      for (int x = 0; x < mask.width(); ++x) {
        cells[static_cast<size_t>(x / cell)] += static_cast<float>(row[static_cast<size_t>(x)]) * one_pixel / 255.0f;
      }
    }
  }
  return raster;
}

double outline_length(const Mask& mask) {
  int64_t borders = 0;
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    uint64_t last = 0;
    for (size_t w = 0; w < row.size(); ++w) {
      const uint64_t shifted = row[w] << 1 | last;
      uint64_t change = row[w] ^ shifted;
      if (w == 0) change &= ~uint64_t{1};
      if (w + 1 == row.size() && mask.width() % 64 != 0) change &= (uint64_t{1} << (mask.width() % 64)) - 1;
      borders += std::popcount(change);
      last = row[w] >> 63;
      if (y > 0) borders += std::popcount(row[w] ^ mask.row(y - 1)[w]);
    }
  }
  return static_cast<double>(borders) * 0.78539816339744831;  // steps of a line of random direction are 4 / pi too long
}

void CoverageDifference::start(const CoverageEvidence::Raster& raster, int rows_per_cell, int num_dofs) {
  const auto size = raster.observed.pixels().size();
  if (raster.observed.width() != width_ || raster.observed.height() != height_ || difference_.size() != size) {
    width_ = raster.observed.width();
    height_ = raster.observed.height();
    difference_.assign(size, 0.0f);
    half_blurred_.assign(size, 0.0f);
    blurred_.assign(size, 0.0f);
    end_of_cell_.assign(size, -1);
  } else {
    for (int y = drawn_y0_; y < drawn_y1_; ++y) {
      const auto row = difference_.begin() + y * width_;
      std::fill(row + drawn_x0_, row + drawn_x1_, 0.0f);
    }
    for (const int32_t cell : end_cells_) end_of_cell_[static_cast<size_t>(cell)] = -1;
  }
  end_cells_.clear();
  raster_ = &raster;
  num_dofs_ = num_dofs;
  per_cell_ = 1.0f / static_cast<float>(raster.cell);
  row_weight_ = 1.0f / static_cast<float>(rows_per_cell);
  model_x0_ = width_, model_y0_ = height_, model_x1_ = model_y1_ = 0;
  drawn_x0_ = drawn_x1_ = drawn_y0_ = drawn_y1_ = 0;
}

void CoverageDifference::add_span(int cell_y, float begin, float end) {
  const float x0 = begin * per_cell_, x1 = end * per_cell_;
  const int first = column_of(begin), last = column_of(end);
  float* const row = difference_.data() + static_cast<ptrdiff_t>(cell_y) * width_;
  if (first == last) {
    row[first] += row_weight_ * (x1 - x0);
  } else {
    row[first] += row_weight_ * (static_cast<float>(first + 1) - x0);
    for (int x = first + 1; x < last; ++x) row[x] += row_weight_;
    row[last] += row_weight_ * (x1 - static_cast<float>(last));
  }
  model_x0_ = std::min(model_x0_, first);
  model_x1_ = std::max(model_x1_, last + 1);
  model_y0_ = std::min(model_y0_, cell_y);
  model_y1_ = std::max(model_y1_, cell_y + 1);
}

void CoverageDifference::add_derivative(int cell_x, int cell_y, std::span<const float> derivative) {
  const int cell = cell_y * width_ + cell_x;
  int32_t& row = end_of_cell_[static_cast<size_t>(cell)];
  const Eigen::Map<const Eigen::RowVectorXf> change(derivative.data(), num_dofs_);
  if (row < 0) {
    row = static_cast<int32_t>(end_cells_.size());
    end_cells_.push_back(cell);
    if (row >= jacobian_.rows() || jacobian_.cols() != num_dofs_) {
      jacobian_.conservativeResize(std::max<Eigen::Index>(2 * row, 512), num_dofs_);
    }
    jacobian_.row(row) = change;
  } else {
    jacobian_.row(row) += change;
  }
}

void CoverageDifference::blur(int x0, int x1, int y0, int y1) {
  // Along rows, then along columns; what lies outside the picture is zero.
  for (int y = drawn_y0_; y < drawn_y1_; ++y) {
    const float* const in = difference_.data() + static_cast<ptrdiff_t>(y) * width_;
    float* const out = half_blurred_.data() + static_cast<ptrdiff_t>(y) * width_;
    for (int x = x0; x < x1; ++x) out[x] = kKernel[0] * in[x];
    for (int d = 1; d <= kRadius; ++d) {
      const float k = kKernel[static_cast<size_t>(d)];
      const int left = std::max(x0, drawn_x0_ - d), right = std::min(x1, drawn_x1_ - d);
      for (int x = left; x < right; ++x) out[x] += k * in[x + d];
      for (int x = std::max(x0, drawn_x0_ + d); x < std::min(x1, drawn_x1_ + d); ++x) out[x] += k * in[x - d];
    }
  }
  for (int y = y0; y < y1; ++y) {
    float* const out = blurred_.data() + static_cast<ptrdiff_t>(y) * width_;
    std::fill(out + x0, out + x1, 0.0f);
    for (int source = std::max(y - kRadius, drawn_y0_); source < std::min(y + kRadius + 1, drawn_y1_); ++source) {
      const float k = kKernel[static_cast<size_t>(std::abs(source - y))];
      const float* const in = half_blurred_.data() + static_cast<ptrdiff_t>(source) * width_;
      for (int x = x0; x < x1; ++x) out[x] += k * in[x];
    }
  }
}

double CoverageDifference::finish() {
  const Box& observed = raster_->occupied;
  drawn_x0_ = std::min(model_x0_, observed.x);
  drawn_y0_ = std::min(model_y0_, observed.y);
  drawn_x1_ = std::max(model_x1_, observed.x + observed.width);
  drawn_y1_ = std::max(model_y1_, observed.y + observed.height);
  for (int y = drawn_y0_; y < drawn_y1_; ++y) {
    float* const row = difference_.data() + static_cast<ptrdiff_t>(y) * width_;
    const auto seen = raster_->observed.row(y);
    for (int x = drawn_x0_; x < drawn_x1_; ++x) row[x] -= seen[static_cast<size_t>(x)];
    if (raster_->confidence.empty()) continue;
    const auto confidence = raster_->confidence.row(y);
    for (int x = drawn_x0_; x < drawn_x1_; ++x) row[x] *= confidence[static_cast<size_t>(x)];
  }
  // D' K D needs K * D where D is not zero; ends lie there, too.
  blur(drawn_x0_, drawn_x1_, drawn_y0_, drawn_y1_);
  double sum = 0;
  for (int y = drawn_y0_; y < drawn_y1_; ++y) {
    const ptrdiff_t row = static_cast<ptrdiff_t>(y) * width_;
    float of_row = 0;
    for (int x = drawn_x0_; x < drawn_x1_; ++x) of_row += difference_[row + x] * blurred_[row + x];
    sum += of_row;
  }
  return sum;
}

void CoverageDifference::add_normal_equations(double weight, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) {
  const auto num_ends = static_cast<Eigen::Index>(end_cells_.size());
  if (num_ends == 0) return;
  if (!raster_->confidence.empty()) {
    for (Eigen::Index i = 0; i < num_ends; ++i) {
      jacobian_.row(i) *= raster_->confidence.pixels()[static_cast<size_t>(end_cells_[static_cast<size_t>(i)])];
    }
  }
  // J' K J = M + M' with M = J' B, B_i = K_ii / 2 J_i + sum of K_ij J_j over the ends j below, or right of, i.
  near_.resize(num_ends, num_dofs_);
  Eigen::VectorXf pull(num_ends);
  for (Eigen::Index i = 0; i < num_ends; ++i) {
    const int cell = end_cells_[static_cast<size_t>(i)];
    const int cell_x = cell % width_, cell_y = cell / width_;
    pull[i] = blurred_[static_cast<size_t>(cell)];
    near_.row(i) = (0.5f * kKernel[0] * kKernel[0]) * jacobian_.row(i);
    for (int y = cell_y; y <= std::min(cell_y + kRadius, height_ - 1); ++y) {
      const int first = y == cell_y ? cell_x + 1 : std::max(cell_x - kRadius, 0);
      const float k = kKernel[static_cast<size_t>(y - cell_y)];
      for (int x = first; x <= std::min(cell_x + kRadius, width_ - 1); ++x) {
        const int32_t j = end_of_cell_[static_cast<size_t>(y * width_ + x)];
        if (j >= 0) near_.row(i) += (k * kKernel[static_cast<size_t>(std::abs(x - cell_x))]) * jacobian_.row(j);
      }
    }
  }
  const auto J = jacobian_.topRows(num_ends);
  const Eigen::MatrixXf half = J.transpose() * near_;
  gradient += weight * (J.transpose() * pull).cast<double>();
  hessian += weight * (half + half.transpose()).cast<double>();
}

}  // namespace silpose
