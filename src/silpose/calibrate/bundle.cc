#include "silpose/calibrate/bundle.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "silpose/base/levenberg_marquardt.h"

namespace silpose {
namespace {

constexpr int kLens = 8, kPose = 6;     // fx fy cx cy k1 k2 p1 p2; turn and shift
constexpr int kCamera = kLens + kPose;  // unknowns of a camera
constexpr int kMostSteps = 50;

using CameraMatrix = Eigen::Matrix<double, kCamera, kCamera>;
using CameraVector = Eigen::Matrix<double, kCamera, 1>;
using PlaceMatrix = Eigen::Matrix<double, kPose, kPose>;
using PlaceVector = Eigen::Matrix<double, kPose, 1>;
using CrossMatrix = Eigen::Matrix<double, kCamera, kPose>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// T turned by step[0..2] and shifted by step[3..5], after it.
Rigid3 moved(const Rigid3& t, const PlaceVector& step) {
  const Eigen::Vector3d turn = step.head<3>();
  Rigid3 result = t;
  if (turn.norm() > 0) {
    result.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * t.rotation;
  }
  // The turn is about the frame's own origin: it is not to shift the far end of a long lever.
  result.translation = t.translation + step.tail<3>();
  return result;
}

// d pixel / d lens [2, 8] for a point in camera coordinates.
Eigen::Matrix<double, 2, kLens> lens_jacobian(const PinholeCamera& camera, const Eigen::Vector3d& x_in_cam,
                                              const Eigen::Vector2d& pixel) {
  const double a = x_in_cam.x() / x_in_cam.z(), b = x_in_cam.y() / x_in_cam.z(), r2 = a * a + b * b;
  const double fx = camera.fx, fy = camera.fy;
  Eigen::Matrix<double, 2, kLens> jacobian;
  jacobian << (pixel.x() - camera.cx) / fx, 0, 1, 0, fx * a * r2, fx * a * r2 * r2, fx * 2 * a * b,
      fx * (r2 + 2 * a * a),  //
      0, (pixel.y() - camera.cy) / fy, 0, 1, fy * b * r2, fy * b * r2 * r2, fy * (r2 + 2 * b * b), fy * 2 * a * b;
  return jacobian;
}

// The normal equations of one view.
struct ViewNormals {
  CameraMatrix camera = CameraMatrix::Zero();
  PlaceMatrix place = PlaceMatrix::Zero();
  CrossMatrix cross = CrossMatrix::Zero();
  CameraVector camera_slope = CameraVector::Zero();
  PlaceVector place_slope = PlaceVector::Zero();
};

ViewNormals linearise(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points, const BundleView& view) {
  ViewNormals normals;
  const PinholeCamera& camera = bundle.cameras[view.camera];
  const Rigid3& place = bundle.places[view.place];
  const Eigen::Matrix3d world_from_cam = camera.cam_from_world.rotation.transpose();
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d lever = place.rotation * points[i], x_in_world = lever + place.translation;
    const Eigen::Vector3d camera_lever = camera.cam_from_world.rotation * x_in_world;
    const Eigen::Vector3d x_in_cam = camera_lever + camera.cam_from_world.translation;
    const Eigen::Vector2d pixel = camera.project_from_camera(x_in_cam);
    const Eigen::Vector2d residual = pixel - (*view.corners)[i];
    const Eigen::Matrix<double, 2, 3> by_world = camera.project_jacobian(x_in_world);
    const Eigen::Matrix<double, 2, 3> by_cam = by_world * world_from_cam;
    Eigen::Matrix<double, 2, kCamera> by_camera;
    by_camera << lens_jacobian(camera, x_in_cam, pixel), -by_cam * cross_matrix(camera_lever), by_cam;
    if (view.camera == 0) by_camera.rightCols<kPose>().setZero();
    Eigen::Matrix<double, 2, kPose> by_place;
    by_place << -by_world * cross_matrix(lever), by_world;
    normals.camera += by_camera.transpose() * by_camera;
    normals.place += by_place.transpose() * by_place;
    normals.cross += by_camera.transpose() * by_place;
    normals.camera_slope += by_camera.transpose() * residual;
    normals.place_slope += by_place.transpose() * residual;
  }
  return normals;
}

// A bundle with its cost, for levenberg_marquardt().
class Adjustment {
 public:
  Adjustment(Bundle bundle, const std::vector<Eigen::Vector3d>& points, const std::vector<BundleView>& views)
      : bundle_(std::move(bundle)), points_(&points), views_(&views) {
    for (const BundleView& view : views) cost_ += view_error(bundle_, points, view);
  }

  [[nodiscard]] double cost() const { return cost_; }
  [[nodiscard]] const Bundle& bundle() const { return bundle_; }

  // Places are eliminated: each meets only the cameras that see it there.
  [[nodiscard]] std::optional<Adjustment> step(double damping) const {
    const auto num_cameras = static_cast<Eigen::Index>(bundle_.cameras.size());
    Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(num_cameras * kCamera, num_cameras * kCamera);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(num_cameras * kCamera);
    std::vector<PlaceMatrix> place(bundle_.places.size(), PlaceMatrix::Zero());
    std::vector<PlaceVector> place_slope(bundle_.places.size(), PlaceVector::Zero());
    std::vector<std::vector<std::pair<Eigen::Index, CrossMatrix>>> cross(bundle_.places.size());  // first row, block
    for (const BundleView& view : *views_) {
      const ViewNormals normals = linearise(bundle_, *points_, view);
      const Eigen::Index row = static_cast<Eigen::Index>(view.camera) * kCamera;
      reduced.block<kCamera, kCamera>(row, row) += normals.camera;
      slope.segment<kCamera>(row) += normals.camera_slope;
      place[view.place] += normals.place;
      place_slope[view.place] += normals.place_slope;
      cross[view.place].emplace_back(row, normals.cross);
    }
    reduced.diagonal() *= 1 + damping;
    reduced.diagonal().segment<kPose>(kLens).setOnes();  // the first camera's pose is held

    std::vector<Eigen::LDLT<PlaceMatrix>> solvers;
    for (size_t p = 0; p < place.size(); ++p) {
      place[p].diagonal() *= 1 + damping;
      solvers.emplace_back(place[p]);
      for (const auto& [row, block] : cross[p]) {
        slope.segment<kCamera>(row) -= block * solvers[p].solve(place_slope[p]);
        for (const auto& [column, other] : cross[p]) {
          reduced.block<kCamera, kCamera>(row, column) -= block * solvers[p].solve(other.transpose());
        }
      }
    }
    const Eigen::VectorXd by_camera = reduced.ldlt().solve(-slope);
    if (!by_camera.allFinite()) return std::nullopt;

    Bundle next = bundle_;
    for (size_t c = 0; c < next.cameras.size(); ++c) {
      const CameraVector change = by_camera.segment<kCamera>(static_cast<Eigen::Index>(c) * kCamera);
      PinholeCamera& camera = next.cameras[c];
      camera.fx += change[0];
      camera.fy += change[1];
      camera.cx += change[2];
      camera.cy += change[3];
      for (size_t k = 0; k < 4; ++k) camera.distortion[k] += change[4 + static_cast<Eigen::Index>(k)];
      if (c > 0) camera.cam_from_world = moved(camera.cam_from_world, change.tail<kPose>());
    }
    for (size_t p = 0; p < place.size(); ++p) {
      PlaceVector right = -place_slope[p];
      for (const auto& [row, block] : cross[p]) right -= block.transpose() * by_camera.segment<kCamera>(row);
      next.places[p] = moved(next.places[p], solvers[p].solve(right));
    }
    return Adjustment(std::move(next), *points_, *views_);
  }

 private:
  Bundle bundle_;
  const std::vector<Eigen::Vector3d>* points_;
  const std::vector<BundleView>* views_;
  double cost_ = 0;
};

}  // namespace

double view_error(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points, const BundleView& view) {
  double sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto pixel = bundle.cameras[view.camera].project(bundle.places[view.place] * points[i]);
    if (!pixel) return std::numeric_limits<double>::infinity();
    sum += (*pixel - (*view.corners)[i]).squaredNorm();
  }
  return sum;
}

Bundle adjust(const Bundle& start, const std::vector<Eigen::Vector3d>& points, const std::vector<BundleView>& views) {
  Adjustment at(start, points, views);
  levenberg_marquardt(at, kMostSteps, {.relative = 1e-9},
                      [](const Adjustment& from, double damping) { return from.step(damping); });
  return at.bundle();
}

}  // namespace silpose
