#include "silpose/calibrate/board.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kPixelCentre = 0.5;  // the library's pixels less OpenCV's
constexpr int kSearchSide = 1280;     // pixels; larger images are made smaller to look for a board in them

// Brightness in the middle of the square whose first corner is (column, row).
double square_brightness(const cv::Mat& grey, const std::vector<cv::Point2f>& corners, const Board& board, int column,
                         int row) {
  const size_t first = static_cast<size_t>(row) * board.columns + column, below = first + board.columns;
  const cv::Point2f middle = (corners[first] + corners[first + 1] + corners[below] + corners[below + 1]) / 4;
  cv::Mat patch;
  cv::getRectSubPix(grey, {3, 3}, middle, patch);
  return cv::mean(patch)[0];
}

// Puts the corners, row by row as they were found, into the order of board_points().
void order_corners(const cv::Mat& grey, const Board& board, std::vector<cv::Point2f>& corners) {
  const cv::Point2f along = corners[board.columns - 1] - corners[0],
                    down = corners[corners.size() - board.columns] - corners[0];
  if (along.cross(down) < 0) {  // a mirror image: rows run the other way
    for (int r = 0; r < board.rows; ++r) {
      std::reverse(corners.begin() + r * board.columns, corners.begin() + (r + 1) * board.columns);
    }
  }
  if (!board.has_one_way_up()) return;
  double difference = 0;  // of light squares less dark ones, were the first square dark
  for (int r = 0; r + 1 < board.rows; ++r) {
    for (int c = 0; c + 1 < board.columns; ++c) {
      difference += ((r + c) % 2 == 0 ? -1 : 1) * square_brightness(grey, corners, board, c, r);
    }
  }
  if (difference < 0) std::reverse(corners.begin(), corners.end());
}

// Corners to about a tenth of a pixel of the image searched; none where there is no board.
std::vector<cv::Point2f> find_roughly(const cv::Mat& grey, cv::Size pattern) {
  const double scale = std::min(1.0, double(kSearchSide) / std::max(grey.cols, grey.rows));
  cv::Mat searched = grey;
  if (scale < 1) cv::resize(grey, searched, {}, scale, scale, cv::INTER_AREA);
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(searched, pattern, corners, cv::CALIB_CB_NORMALIZE_IMAGE)) return {};
  for (cv::Point2f& corner : corners) {
    corner = {static_cast<float>((corner.x + 0.5) / scale - 0.5), static_cast<float>((corner.y + 0.5) / scale - 0.5)};
  }
  return corners;
}

// Looks again where the board is, at full size and with all care, which in the whole image would take long.
void locate_exactly(const cv::Mat& grey, cv::Size pattern, std::vector<cv::Point2f>& corners) {
  const cv::Rect board = cv::boundingRect(corners);
  const int margin = 2 * std::max(board.width, board.height) / std::min(pattern.width, pattern.height);
  const cv::Rect around =
      cv::Rect(board.x - margin, board.y - margin, board.width + 2 * margin, board.height + 2 * margin) &
      cv::Rect(0, 0, grey.cols, grey.rows);
  std::vector<cv::Point2f> exact;
  if (!cv::findChessboardCornersSB(grey(around), pattern, exact, cv::CALIB_CB_ACCURACY)) return;
  corners = std::move(exact);
  for (cv::Point2f& corner : corners) corner += cv::Point2f(around.tl());
}

}  // namespace

std::vector<Eigen::Vector3d> board_points(const Board& board) {
  std::vector<Eigen::Vector3d> points;
  for (int r = 0; r < board.rows; ++r) {
    for (int c = 0; c < board.columns; ++c) points.emplace_back(c * board.square_m, r * board.square_m, 0);
  }
  return points;
}

std::optional<std::vector<Eigen::Vector2d>> find_board(const ByteImage& image, const Board& board, bool thorough) {
  check(image.channels() == 3, "find_board: image of {} channels", image.channels());
  check(board.columns >= 3 && board.rows >= 3, "find_board: board of {}x{} corners", board.columns, board.rows);
  const cv::Mat colour(image.height(), image.width(), CV_8UC3, const_cast<uint8_t*>(image.pixels().data()));
  cv::Mat grey;
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  const cv::Size pattern(board.columns, board.rows);
  std::vector<cv::Point2f> corners = find_roughly(grey, pattern);
  if (!corners.empty()) {
    locate_exactly(grey, pattern, corners);
  } else if (!thorough || !cv::findChessboardCornersSB(grey, pattern, corners, cv::CALIB_CB_ACCURACY)) {
    return std::nullopt;
  }
  order_corners(grey, board, corners);
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(corners.size());
  for (const cv::Point2f& corner : corners) pixels.emplace_back(corner.x + kPixelCentre, corner.y + kPixelCentre);
  return pixels;
}

}  // namespace silpose
