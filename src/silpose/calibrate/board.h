// A printed chessboard, and where its inner corners are in an image.
// Based on: OpenCV's sector-based detector (references.bib: opencv).
// Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "silpose/image/image.h"

namespace silpose {

struct Board {
  int columns = 9, rows = 6;  // inner corners, at least 3 each
  double square_m = 0.025;

  // Rotated by half a turn, a board with an odd and an even number of corners has its colours exchanged; others look
  // the same, and two cameras may disagree on which corner is the first.
  [[nodiscard]] bool has_one_way_up() const { return (columns + rows) % 2 == 1; }
};

// The inner corners [N] row by row in the board's own frame, metres: the first at the origin, x along a row, y to the
// next row, z away from a viewer of the print.
[[nodiscard]] std::vector<Eigen::Vector3d> board_points(const Board& board);

// Pixels [N] of the inner corners in the order of board_points(); nothing where the whole board is not seen. The square
// between the first four is dark where the board has one way up. `thorough` takes up to ten times as long and finds a
// board that is small in a large image, too. REQUIRES: image of 3 channels.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> find_board(const ByteImage& image, const Board& board,
                                                                     bool thorough = false);

}  // namespace silpose
