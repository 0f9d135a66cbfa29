#include "silpose/calibrate/person_camera.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/levenberg_marquardt.h"
#include "silpose/base/median.h"

namespace silpose {
namespace {

// What is unknown of the camera, and of the person's posture throughout the clip.
enum Unknown : Eigen::Index { kLogFocal, kTilt, kRoll, kLogHeight, kReach, kStoop, kLean, kNumUnknowns };
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using Normal = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;
// Where a person stands: metres to the camera's right, and the logarithm of the metres in front of it.
using Place = Eigen::Vector2d;
using Residual = Eigen::Vector4d;  // feet x, y and head x, y

// Of cameras in use, and of people who walk: mean and deviation [guesses]. The focal length is relative to the caller's
// prior, whose deviation comes in place of the 1; the height to a metre; reach is how far in front of the body's axis
// the nearest foot is, metres; stoop how much lower than its height a body stands, lean how far the head is off the
// feet, both in parts of its height.
const Unknowns kPriorMean = (Unknowns() << 0, 0.03, 0, std::log(1.4), 0.22, 0.02, 0).finished();
const Unknowns kPriorDeviation = (Unknowns() << 1, 0.18, 0.02, 0.4, 0.12, 0.02, 0.03).finished();
// Extents are taken as medians over a stride, since feet alternate and heads bob with every step: a window every half
// of it. Deviations of such a median, in parts of the body's height in the image; degrees of freedom of Student's t;
// and as many windows count in full: of a longer clip they resemble each other.
constexpr double kStride_s = 1;
const Residual kNoise(0.02, 0.015, 0.02, 0.01);
constexpr double kUpright = 0.88;       // of the most slender tenth: less crouches; who turns loses up to a tenth
constexpr double kUprightShare = 0.75;  // of a window's frames
constexpr double kTails = 4;
constexpr double kMostWindows = 16;
constexpr int kMostSteps = 60;

struct View {
  FocalPrior focal;
  double cx = 0, cy = 0, body_height = 0;

  [[nodiscard]] bool focal_is_known() const { return focal.deviation == 0; }
  // Of the unknowns. A known focal length keeps 1: no residual depends on it, and it stays where it is.
  [[nodiscard]] Unknowns prior_deviation() const {
    Unknowns deviation = kPriorDeviation;
    if (!focal_is_known()) deviation[kLogFocal] = focal.deviation;
    return deviation;
  }
};

Eigen::Vector2d nowhere() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

// Pixel of the point `right`, `up` above the floor, `ahead` of the camera.
Eigen::Vector2d project(const View& view, const Unknowns& at, double right, double up, double ahead) {
  const double below = std::exp(at[kLogHeight]) - up;
  const double down = std::cos(at[kTilt]) * below - std::sin(at[kTilt]) * ahead;
  const double depth = std::sin(at[kTilt]) * below + std::cos(at[kTilt]) * ahead;
  if (!(depth > PinholeCamera::kNear)) return nowhere();
  const double scale = view.focal.focal_px * std::exp(at[kLogFocal]) / depth;
  const double c = std::cos(at[kRoll]), s = std::sin(at[kRoll]);
  return {view.cx + scale * (c * right - s * down), view.cy + scale * (s * right + c * down)};
}

Residual residual_of(const View& view, const PersonExtent& seen, const Unknowns& at, const Place& place) {
  const double ahead = std::exp(place[1]), height = view.body_height;
  const Eigen::Vector2d nearest = project(view, at, place[0], 0, ahead - at[kReach]);
  const Eigen::Vector2d axis = project(view, at, place[0], 0, ahead);
  const Eigen::Vector2d head = project(view, at, place[0] + at[kLean] * height, (1 - at[kStoop]) * height, ahead);
  Residual residual(axis.x() - seen.feet.x(), nearest.y() - seen.feet.y(), head.x() - seen.head.x(),
                    head.y() - seen.head.y());
  return (residual / seen.height()).cwiseQuotient(kNoise);
}

class PersonFit {
 public:
  // REQUIRES: `extents` that outlive it.
  PersonFit(const View& view, std::span<const PersonExtent> extents, const Unknowns& start)
      : view_(view), extents_(extents), at_(start) {
    const double focal = view.focal.focal_px * std::exp(start[kLogFocal]);
    for (const PersonExtent& seen : extents) {
      const double ahead = focal * view.body_height / seen.height();
      places_.emplace_back((seen.feet.x() - view.cx) / focal * ahead, std::log(ahead));
    }
    cost_ = cost_here();
  }

  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] const Unknowns& at() const { return at_; }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }

  // Places are eliminated: each meets only its own frame. Nothing where no step can be made.
  [[nodiscard]] std::optional<PersonFit> step(double damping) const {
    std::vector<Linearised> frames;
    Unknowns slope;
    Normal normal = reduced(damping, &slope, &frames);
    const Unknowns change = normal.ldlt().solve(-slope);
    if (!change.allFinite()) return std::nullopt;
    PersonFit next = *this;
    next.at_ += change;
    for (size_t i = 0; i < places_.size(); ++i) {
      const Linearised& frame = frames[i];
      next.places_[i] -= frame.place.inverse() * (frame.place_slope + frame.cross.transpose() * change);
    }
    next.cost_ = next.cost_here();
    return next;
  }

  [[nodiscard]] Normal covariance() const { return reduced(0, nullptr, nullptr).inverse(); }

 private:
  struct Linearised {
    Normal unknowns;
    Eigen::Matrix2d place;
    Eigen::Matrix<double, kNumUnknowns, 2> cross;
    Unknowns slope;
    Place place_slope;
  };

  [[nodiscard]] double share() const { return std::min(0.5, kMostWindows / static_cast<double>(extents_.size())); }

  [[nodiscard]] double cost_here() const {
    double sum = (at_ - kPriorMean).cwiseQuotient(view_.prior_deviation()).squaredNorm();
    for (size_t i = 0; i < extents_.size(); ++i) {
      const double squared = residual_of(view_, extents_[i], at_, places_[i]).squaredNorm();
      if (!std::isfinite(squared)) return std::numeric_limits<double>::infinity();
      sum += share() * (kTails + 2) * std::log1p(squared / kTails);
    }
    return sum;
  }

  [[nodiscard]] Linearised linearise(size_t i) const {
    constexpr double kStep = 1e-5;
    const PersonExtent& seen = extents_[i];
    const Residual residual = residual_of(view_, seen, at_, places_[i]);
    Eigen::Matrix<double, 4, kNumUnknowns> by_unknowns;
    for (Eigen::Index u = 0; u < kNumUnknowns; ++u) {
      if (u == kLogFocal && view_.focal_is_known()) {
        by_unknowns.col(u).setZero();
        continue;
      }
      const Unknowns change = kStep * Unknowns::Unit(u);
      by_unknowns.col(u) =
          (residual_of(view_, seen, at_ + change, places_[i]) - residual_of(view_, seen, at_ - change, places_[i])) /
          (2 * kStep);
    }
    Eigen::Matrix<double, 4, 2> by_place;
    for (Eigen::Index u = 0; u < 2; ++u) {
      const Place change = kStep * Place::Unit(u);
      by_place.col(u) =
          (residual_of(view_, seen, at_, places_[i] + change) - residual_of(view_, seen, at_, places_[i] - change)) /
          (2 * kStep);
    }
    const double weight = share() * (kTails + 2) / (kTails + residual.squaredNorm());
    return {weight * by_unknowns.transpose() * by_unknowns, weight * by_place.transpose() * by_place,
            weight * by_unknowns.transpose() * by_place, weight * by_unknowns.transpose() * residual,
            weight * by_place.transpose() * residual};
  }

  // The normal equations of the unknowns, all places at their best.
  [[nodiscard]] Normal reduced(double damping, Unknowns* slope, std::vector<Linearised>* frames) const {
    const Unknowns precision = view_.prior_deviation().cwiseAbs2().cwiseInverse();
    Normal normal = precision.asDiagonal();
    Unknowns down = precision.cwiseProduct(at_ - kPriorMean);
    Normal eliminated = Normal::Zero();
    for (size_t i = 0; i < extents_.size(); ++i) {
      Linearised frame = linearise(i);
      frame.place.diagonal() *= 1 + damping;
      const Eigen::Matrix<double, kNumUnknowns, 2> back = frame.cross * frame.place.inverse();
      normal += frame.unknowns;
      eliminated += back * frame.cross.transpose();
      down += frame.slope - back * frame.place_slope;
      if (frames) frames->push_back(frame);
    }
    normal.diagonal() *= 1 + damping;
    if (slope) *slope = down;
    return normal - eliminated;
  }

  View view_;
  std::span<const PersonExtent> extents_;
  Unknowns at_;
  std::vector<Place> places_;
  double cost_ = 0;
};

// The slenderness of an upright person. REQUIRES: some extents.
double least_slenderness(std::span<const PersonExtent> extents) {
  std::vector<double> all;
  for (const PersonExtent& seen : extents) all.push_back(seen.slenderness);
  const auto tenth = all.begin() + std::ssize(all) * 9 / 10;
  std::nth_element(all.begin(), tenth, all.end());
  return kUpright * *tenth;
}

// Medians over strides in which the person is upright, half a stride apart. REQUIRES: times that do not fall.
std::vector<PersonExtent> over_strides(std::span<const PersonExtent> extents, double upright) {
  std::vector<PersonExtent> windows;
  const double end = extents.back().time_s;
  for (double start = extents.front().time_s; windows.empty() || start + 0.75 * kStride_s <= end;
       start += 0.5 * kStride_s) {
    std::array<std::vector<double>, 4> values;
    int num_seen = 0;
    for (const PersonExtent& seen : extents) {
      if (seen.time_s < start || seen.time_s > start + kStride_s) continue;
      ++num_seen;
      if (seen.slenderness < upright) continue;
      values[0].push_back(seen.head.x());
      values[1].push_back(seen.head.y());
      values[2].push_back(seen.feet.x());
      values[3].push_back(seen.feet.y());
    }
    if (values[0].empty() || static_cast<double>(values[0].size()) < kUprightShare * num_seen) continue;
    std::array<double, 4> middle{};
    for (size_t i = 0; i < 4; ++i) middle[i] = upper_median(std::move(values[i]));
    windows.push_back({start + 0.5 * kStride_s, {middle[0], middle[1]}, {middle[2], middle[3]}, upright});
  }
  return windows;
}

}  // namespace

std::optional<CameraEstimate> estimate_camera(std::span<const PersonExtent> extents, int width, int height,
                                              double body_height_m, const FocalPrior& focal_length) {
  check(width > 0 && height > 0 && body_height_m > 0, "estimate_camera: image {}x{}, body {} m", width, height,
        body_height_m);
  check(focal_length.focal_px > 0 && focal_length.deviation >= 0, "estimate_camera: focal length {} px within {}",
        focal_length.focal_px, focal_length.deviation);
  if (extents.size() < kFewestExtents) return std::nullopt;
  const double upright = least_slenderness(extents);
  const auto num_upright = static_cast<size_t>(
      std::ranges::count_if(extents, [&](const PersonExtent& seen) { return seen.slenderness >= upright; }));
  const std::vector<PersonExtent> windows = over_strides(extents, upright);
  if (num_upright < kFewestExtents || windows.empty()) return std::nullopt;
  const View view{focal_length, width / 2.0, height / 2.0, body_height_m};
  std::optional<PersonFit> best;
  for (const double tilt : {-0.2, 0.0, 0.2, 0.5}) {
    for (const double camera_height : {0.7, 1.5, 2.6}) {
      Unknowns start = kPriorMean;
      start[kTilt] = tilt;
      start[kLogHeight] = std::log(camera_height);
      PersonFit fit(view, windows, start);
      if (!std::isfinite(fit.cost())) continue;
      levenberg_marquardt(fit, kMostSteps, {.absolute = 1e-6},
                          [](const PersonFit& from, double damping) { return from.step(damping); });
      if (!best || fit.cost() < best->cost()) best = std::move(fit);
    }
  }
  if (!best) return std::nullopt;

  const Unknowns at = best->at();
  const Normal covariance = best->covariance();
  const auto deviation = [&](Unknown u) { return std::sqrt(covariance(u, u)); };
  CameraEstimate estimate;
  const double focal = view.focal.focal_px * std::exp(at[kLogFocal]), above = std::exp(at[kLogHeight]);
  estimate.focal_px = {focal, view.focal_is_known() ? 0 : focal * deviation(kLogFocal)};
  estimate.tilt = {at[kTilt], deviation(kTilt)};
  estimate.roll = {at[kRoll], deviation(kRoll)};
  estimate.height_m = {above, above * deviation(kLogHeight)};
  estimate.body_height_m = body_height_m;
  estimate.num_frames = num_upright;
  std::vector<double> distances;
  for (const Place& place : best->places()) distances.push_back(std::exp(place[1]));
  const Eigen::Vector3d camera_centre(0, above, upper_median(std::move(distances)));
  const Eigen::Vector3d ahead(0, -std::sin(at[kTilt]), -std::cos(at[kTilt]));
  estimate.camera = look_at_camera(width, height, focal, camera_centre, camera_centre + ahead);
  const Eigen::Matrix3d roll = Eigen::AngleAxisd(at[kRoll], Eigen::Vector3d::UnitZ()).toRotationMatrix();
  estimate.camera.cam_from_world = Rigid3{roll, Eigen::Vector3d::Zero()} * estimate.camera.cam_from_world;
  return estimate;
}

}  // namespace silpose
