#include "silpose/render/outline_scan.h"

#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// 1 for triangles that wind clockwise on the screen or have no area, -1 for the others.
int8_t facing_of(GridPoint a, GridPoint b, GridPoint c) {
  const int64_t left = int64_t{b.x - a.x} * (c.y - a.y);
  const int64_t right = int64_t{b.y - a.y} * (c.x - a.x);
  return static_cast<int8_t>(left >= right ? 1 : -1);
}

}  // namespace

OutlineScan::OutlineScan(const EdgeTopology& topology)
    : topology_(&topology), facing_(topology.faces.size() + 1, 0), outline_(topology.edges.faces.size()) {}

void OutlineScan::scan(std::span<const GridPoint> points, bool some_unseen, int width, int height) {
  check(points.size() >= topology_->num_vertices, "OutlineScan: {} points for {} vertices", points.size(),
        topology_->num_vertices);
  if (height != height_) {
    row_size_.resize(static_cast<size_t>(height));
    crossings_.resize(static_cast<size_t>(height) * row_capacity_);
  }
  width_ = width;
  height_ = height;
  row_begin_ = height;
  row_end_ = 0;
  std::ranges::fill(row_size_, 0u);

  some_unseen ? find_facing_of_seen(points) : find_facing(points);
  find_outline();
  for (size_t i = 0; i < num_outline_; ++i) {
    const uint32_t edge = outline_[i];
    const auto [along, against] = topology_->edges.faces[edge];
    const auto [from, to] = topology_->edges.vertices[edge];
    add_edge(points[from], points[to], facing_[along] - facing_[against]);
  }
}

void OutlineScan::find_facing(std::span<const GridPoint> points) {
  const std::vector<Face>& faces = topology_->faces;
  for (size_t f = 0; f < faces.size(); ++f) {
    facing_[f] = facing_of(points[faces[f][0]], points[faces[f][1]], points[faces[f][2]]);
  }
}

void OutlineScan::find_facing_of_seen(std::span<const GridPoint> points) {
  const std::vector<Face>& faces = topology_->faces;
  for (size_t f = 0; f < faces.size(); ++f) {
    const GridPoint a = points[faces[f][0]], b = points[faces[f][1]], c = points[faces[f][2]];
    facing_[f] = a.unseen() || b.unseen() || c.unseen() ? int8_t{0} : facing_of(a, b, c);
  }
}

void OutlineScan::find_outline() {
  // Branch-free: every edge is written, and kept by moving on. Few are, and not predictably.
  const auto& edge_faces = topology_->edges.faces;
  size_t count = 0;
  for (uint32_t e = 0; e < edge_faces.size(); ++e) {
    outline_[count] = e;
    count += static_cast<size_t>(facing_[edge_faces[e][0]] != facing_[edge_faces[e][1]]);
  }
  num_outline_ = count;
}

void OutlineScan::add_edge(GridPoint a, GridPoint b, int change) {
  if (a.y > b.y) {
    std::swap(a, b);
    change = -change;
  }
  const int begin = std::max(first_centre_from(a.y), 0);
  const int end = std::min(first_centre_from(b.y), height_);
  if (begin >= end || first_centre_from(std::min(a.x, b.x)) >= width_) return;
  row_begin_ = std::min(row_begin_, begin);
  row_end_ = std::max(row_end_, end);
  // The product is below 2^53, and a quotient of these is further from any integer than the division's rounding: the
  // ceiling is exact.
  const double dx = b.x - a.x, dy = b.y - a.y;
  for (int row = begin; row < end; ++row) {
    const double quotient = dx * (row * kGridPerPixel + kGridHalfPixel - a.y) / dy;
    const auto whole = static_cast<int32_t>(quotient);
    const int column = first_centre_from(a.x + whole + static_cast<int32_t>(whole < quotient));
    if (column < width_) add_crossing(row, static_cast<uint32_t>(std::max(column, 0)), change);
  }
}

void OutlineScan::add_crossing(int row, uint32_t column, int change) {
  uint32_t& size = row_size_[static_cast<size_t>(row)];
  if (size == row_capacity_) grow_rows();
  crossings_[static_cast<size_t>(row) * row_capacity_ + size++] = column << 3 | static_cast<uint32_t>(change + 4);
}

void OutlineScan::grow_rows() {
  std::vector<Crossing> wider(2 * crossings_.size());
  for (size_t row = 0; row < row_size_.size(); ++row) {
    std::copy_n(crossings_.begin() + static_cast<ptrdiff_t>(row * row_capacity_), row_size_[row],
                wider.begin() + static_cast<ptrdiff_t>(2 * row * row_capacity_));
  }
  crossings_ = std::move(wider);
  row_capacity_ *= 2;
}

}  // namespace silpose
