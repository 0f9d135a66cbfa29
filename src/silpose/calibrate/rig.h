// Several cameras: their poses, from instants at which two of them see the board, and the bundle of all sightings.
// For use inside module calibrate. Threads: functions without state.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/calibrate/board.h"
#include "silpose/calibrate/bundle.h"
#include "silpose/calibrate/sighting.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {

// What one camera with a known lens saw: where the board was at an instant.
struct SeenBoard {
  const Sighting* sighting = nullptr;
  Rigid3 cam_from_board;
};
using SeenBoards = std::map<int64_t, SeenBoard>;

[[nodiscard]] SeenBoards seen_boards(const Board& board, const PinholeCamera& camera,
                                     const std::vector<Sighting>& sightings);

// Instants at which both cameras saw the board, up to 20 that differ most.
[[nodiscard]] std::vector<int64_t> shared_instants(const Board& board, const SeenBoards& a, const SeenBoards& b,
                                                   double image_width);

// Gives every camera its pose relative to the first, which keeps its own: along the tree of pairs that share most.
// Errors: a camera that shares no instant with the others, by name.
Result<void> place_cameras(const Board& board, const std::vector<SeenBoards>& seen,
                           std::vector<PinholeCamera>& cameras);

// The bundle of the cameras as they are and the board's poses at `instants`, each as estimated by the camera that
// explains it best; the views of it in `views`, and the place of each instant in `place_of`.
[[nodiscard]] Bundle make_bundle(const Board& board, const std::vector<SeenBoards>& seen,
                                 const std::vector<PinholeCamera>& cameras, const std::vector<int64_t>& instants,
                                 std::vector<BundleView>& views, std::map<int64_t, size_t>& place_of);

}  // namespace silpose
