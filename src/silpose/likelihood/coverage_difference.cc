#include "silpose/likelihood/coverage_difference.h"

#include "silpose/likelihood/coverage_kernels.h"

namespace silpose {

void CoverageDifference::start(const CoverageEvidence::Raster& raster, int rows_per_cell) {
  if (raster.observed.width() != width_ || raster.observed.height() != height_) {
    width_ = raster.observed.width();
    height_ = raster.observed.height();
    stride_ = stride_of(width_);
    difference_.assign(stride_ * static_cast<size_t>(height_), 0.0f);
    rank_.assign(difference_.size(), 0);
  } else {
    for (int y = drawn_y0_; y < drawn_y1_; ++y) {
      std::fill_n(difference_.begin() + static_cast<ptrdiff_t>(at(drawn_x0_, y)), drawn_x1_ - drawn_x0_, 0.0f);
    }
    if (num_end_cells_ > 0) {
      for (int y = model_y0_; y < model_y1_; ++y) {
        std::fill_n(rank_.begin() + static_cast<ptrdiff_t>(at(model_x0_ - kMargin, y)),
                    model_x1_ - model_x0_ + 2 * kMargin, 0);
      }
    }
  }
  num_end_cells_ = 0;
  raster_ = &raster;
  per_cell_ = 1.0f / static_cast<float>(raster.cell);
  row_weight_ = 1.0f / static_cast<float>(rows_per_cell);
  model_x0_ = width_, model_y0_ = height_, model_x1_ = model_y1_ = 0;
  drawn_x0_ = drawn_x1_ = drawn_y0_ = drawn_y1_ = 0;
}

void CoverageDifference::add_span(int cell_y, float begin, float end) {
  const float x0 = begin * per_cell_, x1 = end * per_cell_;
  const int first = column_of(begin), last = column_of(end);
  float* const row = difference_.data() + at(0, cell_y);
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

size_t CoverageDifference::number_cells() {
  const auto most = static_cast<size_t>(std::max(0, model_x1_ - model_x0_) * std::max(0, model_y1_ - model_y0_)) + 1;
  if (end_x_.size() < most) {
    end_x_.resize(most);
    end_y_.resize(most);
  }
  int32_t count = 0;
  for (int y = model_y0_; y < model_y1_; ++y) {
    int32_t* const row = rank_.data() + at(0, y);
    std::fill(row + model_x0_ - kMargin, row + model_x0_, count);
    for (int x = model_x0_; x < model_x1_; ++x) {
      const int32_t holds_end = row[x];
      row[x] = count;
      end_x_[static_cast<size_t>(count)] = x;
      end_y_[static_cast<size_t>(count)] = y;
      count += holds_end;
    }
    std::fill(row + model_x1_, row + model_x1_ + kMargin, count);
  }
  num_end_cells_ = static_cast<size_t>(count);
  return num_end_cells_;
}

float* CoverageDifference::jacobian(size_t stride) {
  jacobian_stride_ = stride;
  if (jacobian_.size() < num_end_cells_ * stride) jacobian_.resize(num_end_cells_ * stride);
  return jacobian_.data();
}

double CoverageDifference::finish() {
  const Box& observed = raster_->occupied;
  drawn_x0_ = std::min(model_x0_, observed.x);
  drawn_y0_ = std::min(model_y0_, observed.y);
  drawn_x1_ = std::max(model_x1_, observed.x + observed.width);
  drawn_y1_ = std::max(model_y1_, observed.y + observed.height);
  for (int y = drawn_y0_; y < drawn_y1_; ++y) {
    float* const row = difference_.data() + at(0, y);
    const auto seen = raster_->observed.row(y);
    for (int x = drawn_x0_; x < drawn_x1_; ++x) row[x] -= seen[static_cast<size_t>(x)];
    if (raster_->confidence.empty()) continue;
    const auto confidence = raster_->confidence.row(y);
    for (int x = drawn_x0_; x < drawn_x1_; ++x) row[x] *= confidence[static_cast<size_t>(x)];
  }
  // D' K D needs K * D where D is not zero; ends lie there, too.
  const auto width = static_cast<size_t>(drawn_x1_ - drawn_x0_), height = static_cast<size_t>(drawn_y1_ - drawn_y0_);
  const size_t size = AlignedFloats::padded(width) * height;
  if (blurred_.size() < size) {
    blurred_.resize(size);
    half_blurred_.resize(size);
  }
  return blur_cells(difference_.data() + at(drawn_x0_, drawn_y0_), stride_, width, height, half_blurred_.data(),
                    blurred_.data());
}

void CoverageDifference::add_normal_equations(double weight, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) {
  const size_t n = num_end_cells_, stride = jacobian_stride_;
  if (n == 0) return;
  const Eigen::Index num_dofs = gradient.size();
  if (half_near_.size() < n * stride) half_near_.resize(n * stride);
  product_.resize(stride * stride);
  const EndCells cells{end_x_.data(), end_y_.data(), n, rank_.data() + at(0, 0), static_cast<ptrdiff_t>(stride_),
                       model_y1_};
  add_near_rows(cells, jacobian_.data(), stride, half_near_.data());
  // The column after the last DOF takes K D, so that the product's has the gradient.
  const size_t padded = AlignedFloats::padded(static_cast<size_t>(drawn_x1_ - drawn_x0_));
  for (size_t i = 0; i < n; ++i) {
    half_near_.data()[i * stride + static_cast<size_t>(num_dofs)] =
        blurred_
            .data()[static_cast<size_t>(end_y_[i] - drawn_y0_) * padded + static_cast<size_t>(end_x_[i] - drawn_x0_)];
  }
  transposed_product(jacobian_.data(), half_near_.data(), n, stride, static_cast<size_t>(num_dofs), product_.data());
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0, Eigen::OuterStride<>>
      product(product_.data(), num_dofs, num_dofs + 1, Eigen::OuterStride<>(static_cast<Eigen::Index>(stride)));
  gradient += weight * product.col(num_dofs).cast<double>();
  const auto half = product.leftCols(num_dofs);
  hessian += weight * (half + half.transpose()).cast<double>();
}

}  // namespace silpose
