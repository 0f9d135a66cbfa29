// FocalPrior: a prior of a camera's focal length: from a user, from a file's metadata, or from the cameras in use.
// Pixels are assumed square, and the principal point in the middle of the image.
// Based on: the pinhole camera; the 35 mm equivalent compares diagonals, as is usual.
// Errors: every function throws std::invalid_argument for sizes, lengths and angles that are not positive.
// Threads: functions without state.
#pragma once

namespace silpose {

struct FocalPrior {
  double focal_px = 0;
  double deviation = 0;  // standard, of the logarithm: about relative; 0: known, and not estimated
};

// Of a clip without information about its camera: assumes a phone or a webcam. [width, height]: pixels.
[[nodiscard]] FocalPrior usual_focal_length(int width, int height);

// The focal length in pixels of an image of that size with the field of view of a lens of `mm` on film of 36 x 24 mm:
// equal angles over the diagonals.
[[nodiscard]] double focal_px_of_mm35(double mm, int width, int height);

// By the field of view along the image's larger side, radians below pi.
[[nodiscard]] double focal_px_of_view(double angle, int width, int height);

// By the 35 mm equivalent in a file's metadata.
[[nodiscard]] FocalPrior focal_length_of_metadata(double mm35, int width, int height);

}  // namespace silpose
