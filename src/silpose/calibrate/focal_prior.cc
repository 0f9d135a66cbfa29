#include "silpose/calibrate/focal_prior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kFilmDiagonal_mm = 43.2666;  // of 36 x 24 mm

// Focal length over the larger side, and its deviation. Two phones in video, calibrated with a printed chessboard, have
// 0.67 and 0.72 [measured]. The main camera of other phones, 24 to 28 mm as 35 mm equivalent in photos, has 0.64 to
// 0.74 by that figure, up to a tenth more where video crops the sensor; wide action cameras have 0.5 to 0.6, webcams of
// 60 to 70 degrees over the diagonal 0.8 to 1.0 [vendors' figures, not measured here]. That 0.75 within 20 % covers
// them, and their share among users' clips, is a guess.
constexpr double kUsual = 0.75, kUsualDeviation = 0.2;
// No sensor in use is nearer to a square than 4:3 [guess: none is known]. A clip that is was cropped, from 4:3 or from
// 16:9, whose larger side is 4/3 of 4:3's at the same height: as an even choice between the two, half of that ratio's
// logarithm is the deviation, and the focal length of 4:3 is its lower end.
constexpr double kSquarest = 4.0 / 3, kOtherwise = 16.0 / 9;
// Whether a clip's tag is of the video or of a photo by the same lens depends on the maker; video shows a part of the
// sensor, up to 1.2 times narrower [guess].
constexpr double kMetadataDeviation = 0.08;

}  // namespace

FocalPrior usual_focal_length(int width, int height) {
  check(width > 0 && height > 0, "usual_focal_length: picture {}x{}", width, height);
  const double larger = std::max(width, height), smaller = std::min(width, height);
  if (larger >= kSquarest * smaller) return {kUsual * larger, kUsualDeviation};
  const double ratio = std::log(kOtherwise / kSquarest);
  return {kUsual * kSquarest * smaller * std::exp(0.5 * ratio), std::hypot(kUsualDeviation, 0.5 * ratio)};
}

double focal_px_of_mm35(double mm, int width, int height) {
  check(mm > 0 && width > 0 && height > 0, "focal_px_of_mm35: {} mm, picture {}x{}", mm, width, height);
  return mm / kFilmDiagonal_mm * std::hypot(width, height);
}

double focal_px_of_view(double angle, int width, int height) {
  check(angle > 0 && angle < std::numbers::pi && width > 0 && height > 0, "focal_px_of_view: {} rad, picture {}x{}",
        angle, width, height);
  return 0.5 * std::max(width, height) / std::tan(0.5 * angle);
}

FocalPrior focal_length_of_metadata(double mm35, int width, int height) {
  return {focal_px_of_mm35(mm35, width, height), kMetadataDeviation};
}

}  // namespace silpose
