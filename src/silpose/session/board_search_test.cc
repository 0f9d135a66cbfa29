#include "silpose/session/board_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/base/option_error.h"

namespace silpose {
namespace {

using ::testing::ElementsAre;

TEST(BoardOf, HasCornersAndMetres) {
  const Board board = board_of("9x6", 25, 2);
  EXPECT_EQ(board.columns, 9);
  EXPECT_EQ(board.rows, 6);
  EXPECT_EQ(board.square_m, 0.025);
  EXPECT_EQ(board_of("9x7", 25, 1).rows, 7) << "one camera cannot confuse its ends";
}

TEST(BoardOf, RefusesOtherFormsAndSizes) {
  for (const char* corners : {"", "9", "9x", "9x6x2", "9by6", "2x6", "9x51"}) {
    EXPECT_THROW(board_of(corners, 25, 1), OptionError) << corners;
  }
  EXPECT_THROW(board_of("9x7", 25, 2), OptionError) << "it looks the same upside down";
}

TEST(CameraNames, AreThoseOfTheFilesUnlessGiven) {
  EXPECT_THAT(camera_names_of({"calib/left.mp4", "right/", "img-%03d.png"}, {}),
              ElementsAre("left", "right", "img-%03d"));
  EXPECT_THAT(camera_names_of({"a.mp4", "b.mp4"}, {"left", "right"}), ElementsAre("left", "right"));
}

TEST(CameraNames, MustDiffer) {
  EXPECT_THROW(camera_names_of({"a/clip.mp4", "b/clip.mp4"}, {}), OptionError);
  EXPECT_THROW(camera_names_of({"a.mp4", "b.mp4"}, {"left"}), OptionError);
  EXPECT_THROW(camera_names_of({"a.mp4"}, {"left/right"}), OptionError);
  EXPECT_THROW(camera_names_of({""}, {}), OptionError);
}

}  // namespace
}  // namespace silpose
