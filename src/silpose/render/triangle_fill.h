// Which pixels lie in a triangle on the grid: the one definition that plain silhouettes, depth and shading share.
// Half-open: centres on a left or top edge are inside, on a right or bottom edge they are not.
// Threads: pure.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "silpose/render/raster_grid.h"

namespace silpose {

// Twice the signed area of (a, b, p): positive where a triangle that winds clockwise on the screen lies.
inline int64_t side_of_edge(GridPoint a, GridPoint b, GridPoint p) {
  return int64_t{b.x - a.x} * (p.y - a.y) - int64_t{b.y - a.y} * (p.x - a.x);
}

inline bool is_on_inner_side(GridPoint a, GridPoint b, int64_t side) {
  const bool left_or_top = b.y < a.y || (b.y == a.y && b.x > a.x);
  return side >= (left_or_top ? 0 : 1);
}

// Calls visit(x, y, wa, wb, wc) for the pixels of [0, width) x [0, height) inside a triangle, with the weights of its
// corners: not negative, and their sum is twice the triangle's area on the grid.
template <class Visit>
void fill_triangle(GridPoint a, GridPoint b, GridPoint c, int width, int height, Visit&& visit) {
  const int64_t area = side_of_edge(a, b, c);
  if (area == 0) return;
  const bool swapped = area < 0;
  if (swapped) std::swap(b, c);
  const auto [x_min, x_max] = std::minmax({a.x, b.x, c.x});
  const auto [y_min, y_max] = std::minmax({a.y, b.y, c.y});
  const int x_begin = std::max(0, first_centre_from(x_min)), x_end = std::min(width, first_centre_from(x_max) + 1);
  const int y_begin = std::max(0, first_centre_from(y_min)), y_end = std::min(height, first_centre_from(y_max) + 1);
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      const GridPoint centre{x * kGridPerPixel + kGridHalfPixel, y * kGridPerPixel + kGridHalfPixel};
      const int64_t ab = side_of_edge(a, b, centre), bc = side_of_edge(b, c, centre), ca = side_of_edge(c, a, centre);
      if (!is_on_inner_side(a, b, ab) || !is_on_inner_side(b, c, bc) || !is_on_inner_side(c, a, ca)) continue;
      visit(x, y, bc, swapped ? ab : ca, swapped ? ca : ab);
    }
  }
}

}  // namespace silpose
