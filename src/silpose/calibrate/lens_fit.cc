#include "silpose/calibrate/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "silpose/base/median.h"

namespace silpose {
namespace {

constexpr size_t kMostViews = 40;
constexpr size_t kFewestViews = 4;
constexpr double kOutlier = 3;     // a view's error against the median one's that makes it suspect
constexpr double kHarmless = 0.3;  // pixels: no view with less is

std::vector<cv::Point3f> object_points(const Board& board) {
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector3d& point : board_points(board)) {
    points.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()), 0.0F);
  }
  return points;
}

std::vector<cv::Point2f> image_points(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<cv::Point2f> points;
  points.reserve(corners.size());
  for (const Eigen::Vector2d& corner : corners) {
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  return points;
}

// OpenCV's calibration of the chosen views; the error of each comes back in `view_rms`.
Result<LensFit> calibrate_views(const Board& board, const CameraSightings& camera, std::vector<size_t> views,
                                std::vector<double>& view_rms) {
  std::vector<std::vector<cv::Point2f>> pixels;
  pixels.reserve(views.size());
  for (const size_t view : views) pixels.push_back(image_points(camera.sightings[view].corners));
  const std::vector<std::vector<cv::Point3f>> points(views.size(), object_points(board));
  cv::Mat matrix, distortion, deviations;
  try {
    std::vector<cv::Mat> rotations, translations;
    // Four distortion coefficients: a fifth (k3) is determined only by images that are full of corners up to their
    // edges.
    cv::calibrateCamera(points, pixels, {camera.width, camera.height}, matrix, distortion, rotations, translations,
                        deviations, cv::noArray(), view_rms, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    matrix = cv::Mat::zeros(3, 3, CV_64F);
  }
  LensFit fit;
  fit.views = std::move(views);
  PinholeCamera& lens = fit.camera;
  lens.name = camera.name;
  lens.width = camera.width;
  lens.height = camera.height;
  lens.fx = matrix.at<double>(0, 0);
  lens.fy = matrix.at<double>(1, 1);
  lens.cx = matrix.at<double>(0, 2);
  lens.cy = matrix.at<double>(1, 2);
  const double longest = 100.0 * std::max(camera.width, camera.height);
  if (!(lens.fx > 1 && lens.fy > 1 && lens.fx < longest && lens.fy < longest && std::isfinite(lens.cx + lens.cy))) {
    return error("{}: the views of the board do not determine the lens; tilt it this way and that, near and far",
                 camera.name);
  }
  std::copy_n(distortion.ptr<double>(), 4, lens.distortion.begin());
  fit.focal_sd_px = std::max(deviations.at<double>(0), deviations.at<double>(1));
  return fit;
}

}  // namespace

std::vector<size_t> choose_views(const std::vector<Eigen::VectorXd>& features, size_t most, double nearest) {
  std::vector<size_t> chosen;
  std::vector<double> distance(features.size(), std::numeric_limits<double>::infinity());  // to the nearest chosen
  for (size_t next = 0; chosen.size() < std::min(most, features.size());) {
    chosen.push_back(next);
    for (size_t i = 0; i < features.size(); ++i) {
      distance[i] = std::min(distance[i], (features[i] - features[next]).norm());
    }
    next = static_cast<size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!(distance[next] >= nearest)) break;
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

Eigen::VectorXd view_feature(const Board& board, double image_width, const Sighting& sighting) {
  const size_t count = sighting.corners.size(), row = static_cast<size_t>(board.columns);
  Eigen::VectorXd feature(8);
  feature << sighting.corners[0], sighting.corners[row - 1], sighting.corners[count - row], sighting.corners[count - 1];
  return feature / image_width;
}

Result<LensFit> fit_lens(const Board& board, const CameraSightings& camera) {
  std::vector<Eigen::VectorXd> features;
  for (const Sighting& sighting : camera.sightings) features.push_back(view_feature(board, camera.width, sighting));
  std::vector<size_t> views = choose_views(features, kMostViews, kNearestViews);
  const auto too_few = [&](size_t count) {
    return error(
        "{}: {} views of the board that differ, in {} frames it was found in; at least {} are needed, 20 are good",
        camera.name, count, camera.sightings.size(), kFewestViews);
  };
  if (views.size() < kFewestViews) return too_few(views.size());
  std::vector<double> view_rms;
  Result<LensFit> fit = calibrate_views(board, camera, views, view_rms);
  if (!fit) return fit;

  // A view that fits far worse than most was moved during its exposure, or found wrongly: once more without it.
  const double limit = std::max(kHarmless, kOutlier * upper_median(view_rms));
  std::vector<size_t> kept;
  for (size_t i = 0; i < views.size(); ++i) {
    if (view_rms[i] <= limit) kept.push_back(views[i]);
  }
  if (kept.size() == views.size()) return fit;
  if (kept.size() < kFewestViews) return too_few(kept.size());
  return calibrate_views(board, camera, std::move(kept), view_rms);
}

std::optional<Rigid3> cam_from_board(const Board& board, const PinholeCamera& camera,
                                     const std::vector<Eigen::Vector2d>& corners) {
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  try {
    if (!cv::solvePnP(object_points(board), image_points(corners), matrix, camera.distortion, rotation, translation)) {
      return std::nullopt;
    }
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  const Eigen::Vector3d turn(rotation[0], rotation[1], rotation[2]);
  Rigid3 pose;
  if (turn.norm() > 0) pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  pose.translation = {translation[0], translation[1], translation[2]};
  if (!pose.translation.allFinite() || pose.translation.z() < PinholeCamera::kNear) return std::nullopt;
  return pose;
}

}  // namespace silpose
