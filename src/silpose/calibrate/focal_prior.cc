#include "silpose/calibrate/focal_prior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kFilmDiagonal_mm = 43.2666;  // of 36 x 24 mm [by definition]

// [guess] Focal length over the larger side, and its deviation. They are to cover the cameras in use, by their share
// among users' clips:
//   - Two phones in video, calibrated with a printed chessboard, have 0.67 and 0.72 [measured].
//   - The main cameras of other phones have 24 to 28 mm as 35 mm equivalent in photos, which is 0.64 to 0.74, and up to
//     a tenth more where video crops the sensor [vendors' figures].
//   - Wide action cameras have 0.5 to 0.6, webcams of 60 to 70 degrees over the diagonal 0.8 to 1.0 [vendors' figures].
constexpr double kUsual = 0.75, kUsualDeviation = 0.2;
// [guess] No sensor in use is nearer to a square than 4:3. A clip that is nearer was cropped, from 4:3 or from 16:9. At
// the same height the larger side of 16:9 is 4/3 of that of 4:3. The prior's middle lies between the two, on a
// logarithmic scale, and half of the ratio's logarithm is added to the deviation.
constexpr double kSquarest = 4.0 / 3, kOtherwise = 16.0 / 9;
// [guess] It depends on the maker whether a clip's tag is of the video or of a photo by the same lens. Video shows a
// part of the sensor, with a field of view up to 1.2 times narrower.
constexpr double kMetadataDeviation = 0.08;

}  // namespace

FocalPrior usual_focal_length(int width, int height) {
  check(width > 0 && height > 0, "usual_focal_length: image {}x{}", width, height);
  const double larger = std::max(width, height), smaller = std::min(width, height);
  if (larger >= kSquarest * smaller) return {kUsual * larger, kUsualDeviation};
  const double ratio = std::log(kOtherwise / kSquarest);
  return {kUsual * kSquarest * smaller * std::exp(0.5 * ratio), std::hypot(kUsualDeviation, 0.5 * ratio)};
}

double focal_px_of_mm35(double mm, int width, int height) {
  check(mm > 0 && width > 0 && height > 0, "focal_px_of_mm35: {} mm, image {}x{}", mm, width, height);
  return mm / kFilmDiagonal_mm * std::hypot(width, height);
}

double focal_px_of_view(double angle, int width, int height) {
  check(angle > 0 && angle < std::numbers::pi && width > 0 && height > 0, "focal_px_of_view: {} rad, image {}x{}",
        angle, width, height);
  return 0.5 * std::max(width, height) / std::tan(0.5 * angle);
}

FocalPrior focal_length_of_metadata(double mm35, int width, int height) {
  return {focal_px_of_mm35(mm35, width, height), kMetadataDeviation};
}

}  // namespace silpose
