#include "silpose/calibrate/rig.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "silpose/base/median.h"
#include "silpose/calibrate/lens_fit.h"

namespace silpose {
namespace {

constexpr size_t kMostShared = 20;

// The pose of b relative to a, of those that single shared instants give, that fits all instants best: with the
// smallest median distance of corners in a's images. A single view of ambiguous tilt, as of a board seen head-on,
// cannot corrupt it.
Rigid3 a_from_b(const Board& board, const PinholeCamera& camera_a, const SeenBoards& a, const SeenBoards& b,
                const std::vector<int64_t>& instants) {
  const std::vector<Eigen::Vector3d> points = board_points(board);
  Rigid3 best;
  double least = std::numeric_limits<double>::infinity();
  for (const int64_t candidate : instants) {
    const Rigid3 pose = a.at(candidate).cam_from_board * b.at(candidate).cam_from_board.inverse();
    std::vector<double> errors;
    for (const int64_t instant : instants) {
      const Rigid3 a_from_board = pose * b.at(instant).cam_from_board;
      const auto& corners = a.at(instant).sighting->corners;
      double sum = 0;
      for (size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d x_in_cam = a_from_board * points[i];
        sum += x_in_cam.z() < PinholeCamera::kNear
                   ? std::numeric_limits<double>::infinity()
                   : (camera_a.project_from_camera(x_in_cam) - corners[i]).squaredNorm();
      }
      errors.push_back(sum);
    }
    const double error_of_candidate = upper_median(std::move(errors));
    if (error_of_candidate < least) least = error_of_candidate, best = pose;
  }
  return best;
}

}  // namespace

SeenBoards seen_boards(const Board& board, const PinholeCamera& camera, const std::vector<Sighting>& sightings) {
  SeenBoards seen;
  for (const Sighting& sighting : sightings) {
    if (const auto pose = cam_from_board(board, camera, sighting.corners)) seen[sighting.instant] = {&sighting, *pose};
  }
  return seen;
}

std::vector<int64_t> shared_instants(const Board& board, const SeenBoards& a, const SeenBoards& b, double image_width) {
  std::vector<int64_t> shared;
  std::vector<Eigen::VectorXd> features;
  for (const auto& [instant, of_a] : a) {
    const auto of_b = b.find(instant);
    if (of_b == b.end()) continue;
    Eigen::VectorXd feature(16);
    feature << view_feature(board, image_width, *of_a.sighting),
        view_feature(board, image_width, *of_b->second.sighting);
    shared.push_back(instant);
    features.push_back(std::move(feature));
  }
  std::vector<int64_t> chosen;
  for (const size_t i : choose_views(features, kMostShared, kNearestViews)) chosen.push_back(shared[i]);
  return chosen;
}

Result<void> place_cameras(const Board& board, const std::vector<SeenBoards>& seen,
                           std::vector<PinholeCamera>& cameras) {
  std::vector<size_t> placed = {0};
  std::set<size_t> left;
  for (size_t c = 1; c < cameras.size(); ++c) left.insert(c);
  while (!left.empty()) {
    size_t from = 0, next = *left.begin();
    std::vector<int64_t> most;
    for (const size_t a : placed) {
      for (const size_t b : left) {
        std::vector<int64_t> shared = shared_instants(board, seen[a], seen[b], cameras[a].width);
        if (shared.size() > most.size()) from = a, next = b, most = std::move(shared);
      }
    }
    if (most.empty()) {
      return error("{}: there is no frame in which this camera and {} see the board together", cameras[next].name,
                   placed.size() == 1 ? cameras[0].name : "another one");
    }
    cameras[next].cam_from_world =
        a_from_b(board, cameras[from], seen[from], seen[next], most).inverse() * cameras[from].cam_from_world;
    placed.push_back(next);
    left.erase(next);
  }
  return {};
}

Bundle make_bundle(const Board& board, const std::vector<SeenBoards>& seen, const std::vector<PinholeCamera>& cameras,
                   const std::vector<int64_t>& instants, std::vector<BundleView>& views,
                   std::map<int64_t, size_t>& place_of) {
  const std::vector<Eigen::Vector3d> points = board_points(board);
  Bundle bundle{.cameras = cameras};
  for (const int64_t instant : instants) {
    const size_t place = bundle.places.size(), first_view = views.size();
    for (size_t c = 0; c < cameras.size(); ++c) {
      const auto found = seen[c].find(instant);
      if (found != seen[c].end()) views.push_back({c, place, &found->second.sighting->corners});
    }
    if (views.size() == first_view) continue;
    Rigid3 best;
    double least = std::numeric_limits<double>::infinity();
    bundle.places.emplace_back();
    for (size_t v = first_view; v < views.size(); ++v) {
      const size_t c = views[v].camera;
      bundle.places[place] = cameras[c].cam_from_world.inverse() * seen[c].at(instant).cam_from_board;
      double sum = 0;
      for (size_t w = first_view; w < views.size(); ++w) sum += view_error(bundle, points, views[w]);
      if (v == first_view || sum < least) least = sum, best = bundle.places[place];
    }
    bundle.places[place] = best;
    place_of[instant] = place;
  }
  return bundle;
}

}  // namespace silpose
