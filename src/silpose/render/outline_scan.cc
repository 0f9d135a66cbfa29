#include "silpose/render/outline_scan.h"

#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// 1 for triangles that wind clockwise on the screen or have no area, -1 for the others.
int8_t facing_of(GridPoint a, GridPoint b, GridPoint c) {
  const int64_t area = int64_t{b.x - a.x} * (c.y - a.y) - int64_t{b.y - a.y} * (c.x - a.x);
  return static_cast<int8_t>(area >> 63 | 1);  // the sign, without a branch: it is as good as random
}

}  // namespace

OutlineScan::OutlineScan(const EdgeTopology& topology)
    : topology_(&topology), facing_(topology.faces.size() + 1, 0), outline_(topology.edges.faces.size() + 1) {}

void OutlineScan::scan(std::span<const GridPoint> points, bool some_unseen, int width, int height) {
  check(points.size() >= topology_->num_vertices, "OutlineScan: {} points for {} vertices", points.size(),
        topology_->num_vertices);
  if (height != height_) {
    row_size_.resize(static_cast<size_t>(height));
    crossings_.resize(static_cast<size_t>(height) * row_capacity_);
  }
  width_ = width;
  height_ = height;
  std::ranges::fill(row_size_, 0u);

  some_unseen ? find_facing_of_seen(points) : find_facing(points);
  find_outline();
  orient_outline(points);
  for (size_t i = 0; i < num_edges_; ++i) add_crossings(edges_[i]);
}

void OutlineScan::find_facing(std::span<const GridPoint> points) {
  // Plain pointers: stores of bytes could else change the vectors themselves, for all the compiler knows.
  const GridPoint* const point = points.data();
  const Face* const face = topology_->faces.data();
  int8_t* const facing = facing_.data();
  const size_t count = topology_->faces.size();
  for (size_t f = 0; f < count; ++f) facing[f] = facing_of(point[face[f][0]], point[face[f][1]], point[face[f][2]]);
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
  const auto* const edge_faces = topology_->edges.faces.data();
  const int8_t* const facing = facing_.data();
  uint32_t* const outline = outline_.data();
  const auto num_edges = static_cast<uint32_t>(topology_->edges.faces.size());
  size_t count = 0;
  for (uint32_t e = 0; e < num_edges; ++e) {
    outline[count] = e;
    count += static_cast<size_t>(facing[edge_faces[e][0]] != facing[edge_faces[e][1]]);
  }
  num_outline_ = count;
}

void OutlineScan::orient_outline(std::span<const GridPoint> points) {
  edges_.resize(std::max(edges_.size(), num_outline_ + 1));
  const auto* const edge_faces = topology_->edges.faces.data();
  const auto* const edge_vertices = topology_->edges.vertices.data();
  OutlineEdge* const edges = edges_.data();
  size_t count = 0;
  int first_row = height_, end_row = 0;
  for (size_t i = 0; i < num_outline_; ++i) {
    const uint32_t edge = outline_[i];
    const auto [along, against] = edge_faces[edge];
    const GridPoint a = points[edge_vertices[edge][0]], b = points[edge_vertices[edge][1]];
    // Again without branches: which end is up, and whether a row's centre lies between, are as good as random.
    const int32_t upwards = (b.y - a.y) >> 31;  // all ones when b is above a
    const GridPoint top{a.x ^ ((a.x ^ b.x) & upwards), a.y ^ ((a.y ^ b.y) & upwards)};
    const GridPoint bottom{a.x ^ b.x ^ top.x, a.y ^ b.y ^ top.y};
    const int change = ((facing_[along] - facing_[against]) ^ upwards) - upwards;
    const int begin = std::max(first_centre_from(top.y), 0);
    const int end = std::min(first_centre_from(bottom.y), height_);
    const bool crosses = begin < end && first_centre_from(std::min(a.x, b.x)) < width_;
    edges[count] = {top, bottom.x - top.x, bottom.y - top.y, begin, end, change};
    first_row = crosses ? std::min(first_row, begin) : first_row;
    end_row = crosses ? std::max(end_row, end) : end_row;
    count += static_cast<size_t>(crosses);
  }
  num_edges_ = count;
  row_begin_ = first_row;
  row_end_ = end_row;
}

void OutlineScan::add_crossings(const OutlineEdge& edge) {
  // The product is below 2^53, and a quotient of these is further from any integer than the division's rounding: the
  // ceiling is exact.
  const double dx = edge.dx, dy = edge.dy;
  int32_t below_top = edge.row_begin * kGridPerPixel + kGridHalfPixel - edge.top.y;
  for (int row = edge.row_begin; row < edge.row_end; ++row, below_top += kGridPerPixel) {
    const double quotient = dx * below_top / dy;
    const auto whole = static_cast<int32_t>(quotient);
    const int column = first_centre_from(edge.top.x + whole + static_cast<int32_t>(whole < quotient));
    if (column >= width_) continue;
    uint32_t& size = row_size_[static_cast<size_t>(row)];
    if (size == row_capacity_) grow_rows();
    crossings_[static_cast<size_t>(row) * row_capacity_ + size++] =
        static_cast<uint32_t>(std::max(column, 0)) << 3 | static_cast<uint32_t>(edge.change + 4);
  }
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
