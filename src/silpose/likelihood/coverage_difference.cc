#include "silpose/likelihood/coverage_difference.h"

#include <algorithm>

namespace silpose {

void CoverageDifference::start(const CoverageEvidence::Raster& raster, int picture_width, int rows_per_cell) {
  if (raster.width != width_ || raster.height != height_) {
    width_ = raster.width;
    height_ = raster.height;
    stride_ = stride_of(height_);
    rank_stride_ = stride_of(width_);
    difference_.assign(at(width_ + 1, 0), 0.0f);
    rank_.assign(rank_at(0, height_), 0);
  } else {
    for (int x = drawn_.x0; x < drawn_.x1 + 1; ++x) {
      std::fill_n(difference_.begin() + static_cast<ptrdiff_t>(at(x, drawn_.y0)), drawn_.y1 - drawn_.y0, 0.0f);
    }
    if (num_end_cells_ > 0) {
      for (int y = model_.y0; y < model_.y1; ++y) {
        std::fill_n(rank_.begin() + static_cast<ptrdiff_t>(rank_at(model_.x0 - kMargin, y)),
                    model_.x1 - model_.x0 + 2 * kMargin, 0);
      }
    }
  }
  num_ends_ = num_end_cells_ = 0;
  raster_ = &raster;
  picture_width_ = static_cast<float>(picture_width);
  rows_per_cell_ = rows_per_cell;
  model_ = drawn_ = {};
}

void CoverageDifference::add_model(const SpanEnds& ends) {
  num_ends_ = ends.count;
  if (num_ends_ == 0) return;
  if (end_at_.size() < num_ends_ + kSpanSpare) {
    for (auto* const numbers : {&end_at_, &end_rank_at_, &number_}) numbers->resize(num_ends_ + kSpanSpare);
    for (auto* const numbers : {&end_here_, &end_beyond_}) numbers->resize(num_ends_ + kSpanSpare);
  }
  const CellGrid grid{.picture_width = picture_width_,
                      .cells_per_pixel = 1.0f / static_cast<float>(raster_->cell),
                      .cells_per_row = 1.0f / static_cast<float>(rows_per_cell_),
                      .last_x = width_ - 1,
                      .stride = static_cast<int32_t>(stride_),
                      .rank_stride = static_cast<int32_t>(rank_stride_),
                      .margin = kMargin};
  model_ = place_ends(ends, grid, {end_at_.data(), end_rank_at_.data(), end_here_.data(), end_beyond_.data()});
  for (size_t i = 0; i < num_ends_; ++i) {
    float* const cell = difference_.data() + end_at_[i];
    cell[0] += end_here_[i];
    cell[stride_] += end_beyond_[i];
  }
}

std::span<const int32_t> CoverageDifference::number_cells() {
  for (size_t i = 0; i < num_ends_; ++i) {
    if (end_rank_at_[i] >= 0) rank_[static_cast<size_t>(end_rank_at_[i])] = 1;
  }
  number_rows();
  for (size_t i = 0; i < num_ends_; ++i) {
    number_[i] = end_rank_at_[i] >= 0 ? rank_[static_cast<size_t>(end_rank_at_[i])] : -1;
  }
  return {number_.data(), num_ends_};
}

void CoverageDifference::number_rows() {
  const size_t most = static_cast<size_t>((model_.x1 - model_.x0) * (model_.y1 - model_.y0)) + 1;
  if (end_x_.size() < most) {
    end_x_.resize(most);
    end_y_.resize(most);
  }
  int32_t count = 0;
  for (int y = model_.y0; y < model_.y1; ++y) {
    int32_t* const row = rank_.data() + rank_at(0, y);
    std::fill(row + model_.x0 - kMargin, row + model_.x0, count);
    for (int x = model_.x0; x < model_.x1; ++x) {
      const int32_t holds_end = row[x];
      row[x] = count;
      end_x_[static_cast<size_t>(count)] = x;
      end_y_[static_cast<size_t>(count)] = y;
      count += holds_end;
    }
    std::fill(row + model_.x1, row + model_.x1 + kMargin, count);
  }
  num_end_cells_ = static_cast<size_t>(count);
}

float* CoverageDifference::jacobian(size_t stride) {
  jacobian_stride_ = stride;
  if (jacobian_.size() < num_end_cells_ * stride) jacobian_.resize(num_end_cells_ * stride);
  return jacobian_.data();
}

double CoverageDifference::finish() {
  const Box& observed = raster_->occupied;
  drawn_ = {observed.x, observed.y, observed.x + observed.width, observed.y + observed.height};
  if (num_ends_ > 0) {
    drawn_ = {std::min(model_.x0, drawn_.x0), std::min(model_.y0, drawn_.y0), std::max(model_.x1, drawn_.x1),
              std::max(model_.y1, drawn_.y1)};
  }
  const auto width = static_cast<size_t>(drawn_.x1 - drawn_.x0), height = static_cast<size_t>(drawn_.y1 - drawn_.y0);
  float* const difference = difference_.data() + at(drawn_.x0, drawn_.y0);
  const size_t first = raster_->at(drawn_.x0, drawn_.y0);
  subtract_observed({.observed = raster_->observed.data() + first,
                     .confidence = raster_->confidence.empty() ? nullptr : raster_->confidence.data() + first,
                     .stride = raster_->stride()},
                    difference, stride_, height, width);
  // D' K D needs K * D where D is not zero; ends lie there, too.
  const size_t size = AlignedFloats::padded(height) * width;
  if (blurred_.size() < size) {
    blurred_.resize(size);
    half_blurred_.resize(size);
  }
  return blur_cells(difference, stride_, height, width, half_blurred_.data(), blurred_.data());
}

void CoverageDifference::add_normal_equations(double weight, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) {
  const size_t n = num_end_cells_, stride = jacobian_stride_;
  if (n == 0) return;
  const Eigen::Index num_dofs = gradient.size();
  if (half_near_.size() < n * stride) half_near_.resize(n * stride);
  product_.resize(stride * stride);
  const EndCells cells{end_x_.data(), end_y_.data(), n, rank_.data() + kMargin, static_cast<ptrdiff_t>(rank_stride_),
                       model_.y1};
  add_near_rows(cells, jacobian_.data(), stride, half_near_.data());
  // The column after the last DOF takes K D, so that the product's has the gradient.
  const size_t padded = AlignedFloats::padded(static_cast<size_t>(drawn_.y1 - drawn_.y0));
  for (size_t i = 0; i < n; ++i) {
    half_near_.data()[i * stride + static_cast<size_t>(num_dofs)] =
        blurred_
            .data()[static_cast<size_t>(end_x_[i] - drawn_.x0) * padded + static_cast<size_t>(end_y_[i] - drawn_.y0)];
  }
  transposed_product(jacobian_.data(), half_near_.data(), n, stride, static_cast<size_t>(num_dofs), product_.data());
  const Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0, Eigen::OuterStride<>>
      product(product_.data(), num_dofs, num_dofs + 1, Eigen::OuterStride<>(static_cast<Eigen::Index>(stride)));
  gradient += weight * product.col(num_dofs).cast<double>();
  const auto half = product.leftCols(num_dofs);
  hessian += weight * (half + half.transpose()).cast<double>();
}

}  // namespace silpose
