// Looks for a board in videos: which frames, and in which of them which camera sees it.
// Threads: a function without state; uses all cores.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/calibrate/board.h"
#include "silpose/calibrate/sighting.h"

namespace silpose {

struct BoardSearch {
  std::vector<CameraSightings> cameras;  // [C] sightings by frame number
  std::optional<int64_t> floor_instant;  // of the frame at floor_s, where some camera sees the board
  int64_t num_searched = 0;              // frames
  std::vector<std::string> warnings;
};

// "9x6" inner corners, and the side of a square. Errors: throws OptionError for another form, a size outside 3x3 to
// 50x50, and a board that looks the same upside down where several cameras see it.
Board board_of(const std::string& corners, double square_mm, size_t num_cameras);

// Names of the cameras of these videos: as given, or after the files: "calib/left.mp4" is "left". [C]
// Errors: throws OptionError for another number of names, two of one name, and a name that is none.
std::vector<std::string> camera_names_of(const std::vector<std::string>& videos, const std::vector<std::string>& given);

// Searches about 200 frames spread over the videos, which are in step, and the one at `floor_s` (seconds; of input that
// carries no rate, at `fps`, or 30 with a warning). Names [C].
// Errors: those of open_video(); a live camera; no board anywhere in a video, or in any at `floor_s`; interrupted.
Result<BoardSearch> search_board(const Board& board, const std::vector<std::string>& videos,
                                 const std::vector<std::string>& names, std::optional<double> floor_s,
                                 std::optional<double> fps, ProgressSink& progress);

}  // namespace silpose
