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

// Searches about 200 frames spread over the videos, which are in step, and the one at `floor_s` (seconds; of input that
// carries no rate, at `fps`, or 30 with a warning). Names [C].
// Errors: those of open_video(); a live camera; no board anywhere in a video, or in any at `floor_s`; interrupted.
Result<BoardSearch> search_board(const Board& board, const std::vector<std::string>& videos,
                                 const std::vector<std::string>& names, std::optional<double> floor_s,
                                 std::optional<double> fps, ProgressSink& progress);

}  // namespace silpose
