// One camera by itself: its lens from views of the board that differ, and where the board is in a view.
// Based on: Zhang's method (references.bib: zhang2000) and OpenCV's refinement of it (opencv).
// For use inside module calibrate. Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/calibrate/board.h"
#include "silpose/calibrate/sighting.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {

inline constexpr double kNearestViews = 0.02;  // of the image's width: nearer views are redundant

// Views that differ from each other most, as indices in ascending order: at most `most`, no two nearer than `nearest`.
// `features`: one vector per view; their Euclidean distance is how different two are. The first chosen is the first
// view.
// Source: farthest-point selection (references.bib: gonzalez1985).
[[nodiscard]] std::vector<size_t> choose_views(const std::vector<Eigen::VectorXd>& features, size_t most,
                                               double nearest);

// How a view looks: its outer corners, in parts of the image's width. [8]
[[nodiscard]] Eigen::VectorXd view_feature(const Board& board, double image_width, const Sighting& sighting);

struct LensFit {
  PinholeCamera camera;       // its pose is left unchanged
  std::vector<size_t> views;  // indices of the sightings that it used
  double focal_sd_px = 0;
};

// Errors: those of calibrate_cameras() that are of one camera.
Result<LensFit> fit_lens(const Board& board, const CameraSightings& camera);

// Where the board is, from its corners. Nothing where no pose fits.
[[nodiscard]] std::optional<Rigid3> cam_from_board(const Board& board, const PinholeCamera& camera,
                                                   const std::vector<Eigen::Vector2d>& corners);

}  // namespace silpose
