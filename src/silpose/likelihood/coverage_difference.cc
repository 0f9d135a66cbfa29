#include "silpose/likelihood/coverage_difference.h"

#include <algorithm>

namespace silpose {
namespace {

constexpr int kReach = kBlurRadius + 1;  // [definition] cells around the model's that are looked up

}  // namespace

void CoverageDifference::start(const CoverageEvidence::Raster& raster, int image_width, int rows_per_cell) {
  if (raster.width != width_ || raster.height != height_) {
    width_ = raster.width;
    height_ = raster.height;
    stride_ = stride_of(height_);
    rank_stride_ = stride_of(width_);
    difference_.assign(at(width_ + 1, 0), 0.0f);
    rank_.assign(rank_at(0, height_), 0);
    words_ = static_cast<size_t>(width_) / 64 + 1;
    holds_end_.assign(words_ * static_cast<size_t>(height_), 0);
  } else {
    for (int x = drawn_.x0; x < drawn_.x1 + 1; ++x) {
      std::fill_n(difference_.begin() + static_cast<ptrdiff_t>(at(x, drawn_.y0)), drawn_.y1 - drawn_.y0, 0.0f);
    }
    if (num_end_cells_ > 0) {
      std::fill(holds_end_.begin() + static_cast<ptrdiff_t>(words_) * model_.y0,
                holds_end_.begin() + static_cast<ptrdiff_t>(words_) * model_.y1, 0);
    }
  }
  num_ends_ = num_end_cells_ = 0;
  raster_ = &raster;
  image_width_ = static_cast<float>(image_width);
  rows_per_cell_ = rows_per_cell;
  model_ = drawn_ = {};
}

void CoverageDifference::add_model(const SpanEnds& ends) {
  num_ends_ = ends.count;
  if (num_ends_ == 0) return;
  if (end_at_.size() < num_ends_ + kSpanSpare) {
    const size_t size = num_ends_ + kSpanSpare;
    for (auto* const numbers : {&end_cell_x_, &end_cell_y_, &end_at_, &number_}) numbers->resize(size);
    for (auto* const numbers : {&end_here_, &end_beyond_}) numbers->resize(size);
  }
  const CellGrid grid{.image_width = image_width_,
                      .cells_per_pixel = 1.0f / static_cast<float>(raster_->cell),
                      .cells_per_row = 1.0f / static_cast<float>(rows_per_cell_),
                      .last_x = width_ - 1,
                      .stride = static_cast<int32_t>(stride_),
                      .margin = kMargin};
  model_ = place_ends(ends, grid,
                      {end_cell_x_.data(), end_cell_y_.data(), end_at_.data(), end_here_.data(), end_beyond_.data()});
  for (size_t i = 0; i < num_ends_; ++i) {
    float* const cell = difference_.data() + end_at_[i];
    cell[0] += end_here_[i];
    cell[stride_] += end_beyond_[i];
  }
}

std::span<const int32_t> CoverageDifference::number_cells() {
  for (size_t i = 0; i < num_ends_; ++i) {
    if (end_cell_x_[i] < 0) continue;
    const auto x = static_cast<size_t>(end_cell_x_[i]);
    holds_end_[static_cast<size_t>(end_cell_y_[i]) * words_ + x / 64] |= uint64_t{1} << (x % 64);
  }
  if (end_x_.size() < num_ends_ + kMargin) {
    end_x_.resize(num_ends_ + kMargin);
    end_y_.resize(num_ends_ + kMargin);
  }
  num_end_cells_ = 0;
  for (int y = model_.y0; y < model_.y1; ++y) {
    number_row(holds_end_.data() + static_cast<size_t>(y) * words_, model_, y, kReach, rank_.data() + rank_at(0, y),
               {end_x_.data(), end_y_.data(), &num_end_cells_});
  }
  for (size_t i = 0; i < num_ends_; ++i) {
    number_[i] = end_cell_x_[i] < 0 ? -1 : rank_[rank_at(end_cell_x_[i], end_cell_y_[i])];
  }
  return {number_.data(), num_ends_};
}

CoverageDifference::Jacobian CoverageDifference::jacobian(size_t stride) {
  jacobian_stride_ = stride;
  if (jacobian_.size() < num_end_cells_ * stride) jacobian_.resize(num_end_cells_ * stride);
  if (blocks_.size() < num_end_cells_ + kMargin) blocks_.resize(num_end_cells_ + kMargin);
  return {jacobian_.data(), blocks_.data()};
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

void CoverageDifference::add_normal_equations(double weight, std::span<const uint32_t> columns,
                                              Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) {
  const size_t n = num_end_cells_, stride = jacobian_stride_, num_blocks = stride / AlignedFloats::kLanes;
  if (n == 0) return;
  if (half_near_.size() < n * stride) half_near_.resize(n * stride);
  if (near_blocks_.size() < n) {
    near_blocks_.resize(n);
    blurred_at_ends_.resize(n);
    for (auto* const bits : {&bits_, &near_bits_}) bits->resize(num_blocks * words_of_bits(n));
  }
  product_.resize(stride * stride + stride);
  float* const product = product_.data();
  float* const sum = product + stride * stride;

  const size_t padded = AlignedFloats::padded(static_cast<size_t>(drawn_.y1 - drawn_.y0));
  for (size_t i = 0; i < n; ++i) {
    const auto x = static_cast<size_t>(end_x_[i] - drawn_.x0), y = static_cast<size_t>(end_y_[i] - drawn_.y0);
    blurred_at_ends_[i] = blurred_.data()[x * padded + y];
  }
  weighted_sum(jacobian_.data(), blurred_at_ends_.data(), n, stride, sum);

  const EndCells cells{.x = end_x_.data(),
                       .y = end_y_.data(),
                       .blocks = blocks_.data(),
                       .count = n,
                       .rank = rank_.data() + kMargin,
                       .rank_stride = static_cast<ptrdiff_t>(rank_stride_),
                       .y_end = model_.y1};
  add_near_rows(cells, jacobian_.data(), stride, half_near_.data(), near_blocks_.data());
  find_bits(blocks_.data(), n, num_blocks, bits_.data());
  find_bits(near_blocks_.data(), n, num_blocks, near_bits_.data());
  transposed_product({jacobian_.data(), bits_.data()}, {half_near_.data(), near_bits_.data()}, n, stride, product);

  for (size_t c = 0; c < columns.size(); ++c) {
    const size_t column = columns[c];
    const auto of_c = static_cast<Eigen::Index>(c);
    gradient[of_c] += weight * static_cast<double>(sum[column]);
    for (size_t r = 0; r < columns.size(); ++r) {
      const size_t row = columns[r];
      hessian(static_cast<Eigen::Index>(r), of_c) +=
          weight * static_cast<double>(product[row * stride + column] + product[column * stride + row]);
    }
  }
}

}  // namespace silpose
