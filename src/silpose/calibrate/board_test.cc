#include "silpose/calibrate/board.h"

#include <gtest/gtest.h>

#include "silpose/calibrate/board_for_test.h"

namespace silpose {
namespace {

PinholeCamera lens() {
  PinholeCamera camera = look_at_camera(480, 360, 420, {0, 1, 1}, {0, 1, 0});
  camera.distortion = {-0.2, 0.05, 0.001, -0.001, 0};
  return camera;
}

// Largest distance of a found corner from where it is.
double largest_error(const Board& board, const PinholeCamera& camera, const Rigid3& pose,
                     const std::vector<Eigen::Vector2d>& found) {
  double largest = 0;
  const auto points = board_points(board);
  for (size_t i = 0; i < points.size(); ++i) {
    largest = std::max(largest, (found[i] - *camera.project(pose * points[i])).norm());
  }
  return largest;
}

TEST(FindBoardTest, CornersAreWhereTheyAreAndInOrderWhicheverWayTheBoardIsTurned) {
  const Board board{.columns = 7, .rows = 4, .square_m = 0.05};
  const BoardFilm film(lens());
  Rng rng(5);
  for (const double roll : {0.0, 1.6, 3.1}) {
    const Rigid3 pose = board_towards(board, {0.05, 1, 0}, {0, 1, 1}, {0.4, -0.3, roll});
    const auto found = find_board(film.image(board, pose, rng), board);
    ASSERT_TRUE(found) << roll;
    EXPECT_LT(largest_error(board, film.camera(), pose, *found), 0.3) << roll;
  }
}

TEST(FindBoardTest, CornersInLargeImagesAreAsExact) {
  PinholeCamera camera = look_at_camera(1440, 810, 1200, {0, 1, 1}, {0, 1, 0});
  const Board board{.columns = 6, .rows = 5, .square_m = 0.06};
  const BoardFilm film(camera);
  Rng rng(6);
  const Rigid3 pose = board_towards(board, {0.02, 1, 0}, {0, 1, 1}, {0.3, 0.4, 0.2});
  const auto found = find_board(film.image(board, pose, rng), board);
  ASSERT_TRUE(found);
  EXPECT_LT(largest_error(board, camera, pose, *found), 0.3);
}

TEST(FindBoardTest, AThoroughSearchFindsABoardFarAwayOnTheFloor) {
  const Board board{.columns = 9, .rows = 6, .square_m = 0.03};
  const BoardFilm film(look_at_camera(1920, 540, 1600, {0, 1.5, 0}, {0, 0, -4}));
  Rng rng(8);
  const Rigid3 pose = board_on_floor(board, 0.1, -4);
  const ByteImage image = film.image(board, pose, rng);
  EXPECT_FALSE(find_board(image, board));
  const auto found = find_board(image, board, true);
  ASSERT_TRUE(found);
  EXPECT_LT(largest_error(board, film.camera(), pose, *found), 0.5);
}

TEST(FindBoardTest, NothingWhereThereIsNoneOrOnlyPartOfIt) {
  const Board board{.columns = 7, .rows = 4, .square_m = 0.05};
  const BoardFilm film(lens());
  Rng rng(7);
  EXPECT_FALSE(find_board(ByteImage(320, 240, 3, uint8_t{90}), board));
  EXPECT_FALSE(find_board(film.image(board, board_towards(board, {0.5, 1, 0}, {0.5, 1, 1}, {0, 0, 0}), rng), board));
}

}  // namespace
}  // namespace silpose
