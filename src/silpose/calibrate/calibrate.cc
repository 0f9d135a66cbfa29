#include "silpose/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "silpose/base/check.h"
#include "silpose/base/median.h"
#include "silpose/calibrate/lens_fit.h"
#include "silpose/calibrate/rig.h"

namespace silpose {
namespace {

// What makes a calibration doubtful.
constexpr double kBadRms = 1;  // pixels
constexpr int kFewViews = 10;
constexpr double kLittleCoverage = 0.5;
constexpr double kVagueFocal = 0.005;  // of the focal length
constexpr double kUpright = 0.5;       // cosine between the cameras' mean up direction and the board's

// A view that the others contradict: moved while the cameras took it, or found wrongly.
constexpr double kOutlier = 4;     // times the median error
constexpr double kHarmless = 1;    // pixels: no view with less is
constexpr double kMisplaced = 20;  // the same before anything is adjusted, when camera poses are only approximate

double rms_of(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points, const BundleView& view) {
  return std::sqrt(view_error(bundle, points, view) / static_cast<double>(points.size()));
}

// Views that are accepted, with the places that are left of the bundle. The views of `kept_place` (or none: the number
// of places) all stay.
Bundle without_outliers(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points, double harmless,
                        size_t kept_place, std::vector<BundleView>& views, std::map<int64_t, size_t>& place_of) {
  std::vector<double> errors;
  errors.reserve(views.size());
  for (const BundleView& view : views) errors.push_back(rms_of(bundle, points, view));
  const double limit = std::max(harmless, kOutlier * upper_median(errors));

  Bundle result{.cameras = bundle.cameras};
  std::vector<BundleView> kept;
  std::map<size_t, size_t> new_place;
  for (size_t v = 0; v < views.size(); ++v) {
    if (errors[v] > limit && views[v].place != kept_place) continue;
    const auto [entry, is_new] = new_place.emplace(views[v].place, result.places.size());
    if (is_new) result.places.push_back(bundle.places[views[v].place]);
    kept.push_back({views[v].camera, entry->second, views[v].corners});
  }
  std::map<int64_t, size_t> new_place_of;
  for (const auto& [instant, place] : place_of) {
    if (new_place.contains(place)) new_place_of[instant] = new_place[place];
  }
  views = std::move(kept);
  place_of = std::move(new_place_of);
  return result;
}

// Instants that the whole fit rests on: each camera's lens views, what pairs share, and the floor.
std::vector<int64_t> chosen_instants(const Board& board, const std::vector<CameraSightings>& cameras,
                                     const std::vector<LensFit>& lenses, const std::vector<SeenBoards>& seen,
                                     std::optional<int64_t> floor_instant) {
  std::set<int64_t> instants;
  for (size_t c = 0; c < cameras.size(); ++c) {
    for (const size_t view : lenses[c].views) instants.insert(cameras[c].sightings[view].instant);
    for (size_t other = c + 1; other < cameras.size(); ++other) {
      const auto shared = shared_instants(board, seen[c], seen[other], cameras[c].width);
      instants.insert(shared.begin(), shared.end());
    }
  }
  if (floor_instant) instants.insert(*floor_instant);
  return {instants.begin(), instants.end()};
}

// New world from old: the floor under the board, Y up, the board's middle the origin; +Z looks to `camera_centre`.
Rigid3 floor_from_world(const Board& board, const Rigid3& world_from_board, const Eigen::Vector3d& camera_centre) {
  const Eigen::Vector3d middle = world_from_board * Eigen::Vector3d((board.columns - 1) * board.square_m / 2,
                                                                    (board.rows - 1) * board.square_m / 2, 0);
  const Eigen::Vector3d up = -world_from_board.rotation.col(2);
  Eigen::Vector3d towards = world_from_board.rotation.col(0);
  for (const double sign : {1.0, -1.0}) {
    for (const int axis : {0, 1}) {
      const Eigen::Vector3d side = sign * world_from_board.rotation.col(axis);
      if (side.dot(camera_centre - middle) > towards.dot(camera_centre - middle)) towards = side;
    }
  }
  Rigid3 result;
  result.rotation.row(0) = up.cross(towards);
  result.rotation.row(1) = up;
  result.rotation.row(2) = towards;
  result.translation = -(result.rotation * middle);
  return result;
}

// Puts the cameras, until now relative to the first, into the world of the floor.
void set_world(const Rigid3& new_from_old, std::vector<PinholeCamera>& cameras) {
  for (PinholeCamera& camera : cameras) camera.cam_from_world = camera.cam_from_world * new_from_old.inverse();
}

// Part of the image's cells in which the views have corners.
double coverage(const PinholeCamera& camera, size_t camera_idx, const std::vector<BundleView>& views) {
  constexpr int kAcross = 6, kDown = 4;
  std::set<int> cells;
  for (const BundleView& view : views) {
    if (view.camera != camera_idx) continue;
    for (const Eigen::Vector2d& corner : *view.corners) {
      const int column = std::clamp(static_cast<int>(corner.x() / camera.width * kAcross), 0, kAcross - 1);
      const int row = std::clamp(static_cast<int>(corner.y() / camera.height * kDown), 0, kDown - 1);
      cells.insert(row * kAcross + column);
    }
  }
  return static_cast<double>(cells.size()) / (kAcross * kDown);
}

void warn_of_camera(const PinholeCamera& camera, const CameraFit& fit, std::vector<std::string>& warnings) {
  const double focal = std::max(camera.fx, camera.fy);
  if (fit.rms_px > kBadRms) {
    warnings.push_back(
        fmt::format("{}: corners are {:.2f} px (RMS) from where the calibration puts them; {:g} px is "
                    "bad: a bent board, a blurred or a moving image",
                    camera.name, fit.rms_px, kBadRms));
  }
  if (fit.num_views < kFewViews) {
    warnings.push_back(
        fmt::format("{}: only {} views of the board that differ; 20 are good", camera.name, fit.num_views));
  }
  if (fit.focal_sd_px > kVagueFocal * focal) {
    warnings.push_back(
        fmt::format("{}: the views determine the focal length to {:.1f} % only; tilt the board, this way and "
                    "that, near and far",
                    camera.name, 100 * fit.focal_sd_px / focal));
  }
  if (fit.coverage < kLittleCoverage) {
    warnings.push_back(
        fmt::format("{}: the board was seen in {:.0f} % of the image only; elsewhere the lens is a guess", camera.name,
                    100 * fit.coverage));
  }
}

// How well each camera fits, with warnings of those that fit badly.
void judge_cameras(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points,
                   const std::vector<BundleView>& views, const std::vector<LensFit>& lenses,
                   CameraCalibration& result) {
  double sum = 0;
  for (size_t c = 0; c < bundle.cameras.size(); ++c) {
    CameraFit fit{.focal_sd_px = lenses[c].focal_sd_px, .coverage = coverage(bundle.cameras[c], c, views)};
    double of_camera = 0;
    for (const BundleView& view : views) {
      if (view.camera != c) continue;
      of_camera += view_error(bundle, points, view);
      ++fit.num_views;
    }
    fit.rms_px = std::sqrt(of_camera / static_cast<double>(points.size() * std::max(1, fit.num_views)));
    sum += of_camera;
    warn_of_camera(bundle.cameras[c], fit, result.warnings);
    result.fits.push_back(fit);
  }
  result.rms_px = std::sqrt(sum / static_cast<double>(points.size() * views.size()));
}

// Moves the cameras into the world whose floor the board lay on at `place`.
void stand_on_board(const Board& board, const Rigid3& place, Bundle& bundle, std::vector<std::string>& warnings) {
  set_world(floor_from_world(board, place, bundle.cameras[0].centre_in_world()), bundle.cameras);
  double up = 0;
  for (const PinholeCamera& camera : bundle.cameras) up -= camera.cam_from_world.rotation(1, 1);
  if (up < kUpright * static_cast<double>(bundle.cameras.size())) {
    warnings.emplace_back("the cameras would be lying on their sides: did the board lie on the floor then?");
  }
}

// Moves the cameras into a world in which the first one is level.
void assume_level(Bundle& bundle, std::vector<std::string>& warnings) {
  const PinholeCamera& first = bundle.cameras[0];
  const PinholeCamera level = default_camera(first.width, first.height);
  warnings.push_back(
      fmt::format("the floor was not specified: camera {} is assumed to be level and 1.5 m above it", first.name));
  set_world(level.cam_from_world.inverse() * first.cam_from_world, bundle.cameras);
}

}  // namespace

Result<CameraCalibration> calibrate_cameras(const Board& board, const std::vector<CameraSightings>& cameras,
                                            std::optional<int64_t> floor_instant) {
  check(!cameras.empty(), "calibrate_cameras: no camera");
  check(cameras.size() == 1 || board.has_one_way_up(), "calibrate_cameras: a board of {}x{} looks the same upside down",
        board.columns, board.rows);
  const std::vector<Eigen::Vector3d> points = board_points(board);
  std::vector<LensFit> lenses;
  std::vector<PinholeCamera> placed;
  std::vector<SeenBoards> seen;
  for (const CameraSightings& camera : cameras) {
    Result<LensFit> lens = fit_lens(board, camera);
    if (!lens) return lens.failure();
    placed.push_back(lens->camera);
    seen.push_back(seen_boards(board, lens->camera, camera.sightings));
    lenses.push_back(std::move(*lens));
  }
  if (const Result<void> done = place_cameras(board, seen, placed); !done) return done.failure();

  std::vector<BundleView> views;
  std::map<int64_t, size_t> place_of;
  const auto instants = chosen_instants(board, cameras, lenses, seen, floor_instant);
  Bundle bundle = make_bundle(board, seen, placed, instants, views, place_of);
  if (floor_instant && !place_of.contains(*floor_instant)) {
    return error("{}: the board was not found where it should lie on the floor", cameras[0].name);
  }
  const size_t num_seen = views.size();
  for (const double harmless : {kMisplaced, kHarmless}) {
    const size_t kept_place = floor_instant ? place_of.at(*floor_instant) : bundle.places.size();
    bundle = adjust(without_outliers(bundle, points, harmless, kept_place, views, place_of), points, views);
  }

  CameraCalibration result;
  judge_cameras(bundle, points, views, lenses, result);
  if (cameras.size() > 1 && views.size() < num_seen - num_seen / 4) {
    result.warnings.push_back(
        fmt::format("{} of {} views contradict the others and were left out; are the videos in step?",
                    num_seen - views.size(), num_seen));
  }
  if (floor_instant) {
    stand_on_board(board, bundle.places[place_of.at(*floor_instant)], bundle, result.warnings);
  } else {
    assume_level(bundle, result.warnings);
  }
  result.cameras = std::move(bundle.cameras);
  return result;
}

}  // namespace silpose
