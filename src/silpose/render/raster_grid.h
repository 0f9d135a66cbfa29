// The grid of 1/256 raster pixel that every silhouette is drawn on, and the rounding to it. On the grid all decisions
// are exact: coordinates stay within +-2^25, so products of differences are exact in int64_t and in double.
// Threads: values and pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

#include "silpose/shape/window.h"

namespace silpose {

struct GridPoint {
  int32_t x = 0, y = 0;
  [[nodiscard]] bool unseen() const { return x == std::numeric_limits<int32_t>::min(); }
};

inline constexpr int kGridBits = 8;
inline constexpr int32_t kGridPerPixel = 1 << kGridBits;
inline constexpr int32_t kGridHalfPixel = kGridPerPixel / 2;
inline constexpr int32_t kGridLimit = 1 << 25;
inline constexpr GridPoint kUnseenPoint{std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::min()};

// The first raster row or column whose centre lies at or beyond a grid coordinate.
inline int32_t first_centre_from(int32_t grid) { return (grid + kGridPerPixel - 1 - kGridHalfPixel) >> kGridBits; }

// Four numbers that the compiler keeps in one register; Eigen does not convert between float and int in registers.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

// Image coordinates to the grid: nearest, halves away from zero, clamped to the limit; NaN goes to the lower one.
struct GridAxis {
  GridAxis(double origin, double scale)
      : slope(static_cast<float>(scale * kGridPerPixel)), offset(static_cast<float>(-origin * scale * kGridPerPixel)) {}
  float slope, offset;

  // Twice the rest, truncated, is the 1 or -1 by which truncation has to be put right.
  [[nodiscard]] Int4 round(const Eigen::Array4f& pixel) const {
    constexpr auto kLimit = static_cast<float>(kGridLimit);
    constexpr Float4 kLowest = {-kLimit, -kLimit, -kLimit, -kLimit}, kHighest = {kLimit, kLimit, kLimit, kLimit};
    const Eigen::Array4f exact = pixel * slope + offset;
    Float4 grid;
    std::memcpy(&grid, exact.data(), sizeof grid);
    grid = grid > kLowest ? grid : kLowest;
    grid = grid < kHighest ? grid : kHighest;
    const Int4 whole = __builtin_convertvector(grid, Int4);
    const Float4 rest = grid - __builtin_convertvector(whole, Float4);
    return whole + __builtin_convertvector(rest + rest, Int4);
  }
};

// Image pixels [V] to grid points [V] of a window; NaN becomes kUnseenPoint. Returns whether there was any.
bool round_to_grid(std::span<const Eigen::Vector2f> pixels, const Window& window, std::span<GridPoint> points);

}  // namespace silpose
