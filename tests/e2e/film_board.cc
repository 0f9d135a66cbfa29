// film_board FOLDER: two cameras film a chessboard of 8x5 corners and 60 mm squares that is carried around and lies on
// the floor from 1.2 s on, at 25 frames per second: left.mp4, right.mp4, and the cameras as they are, truth.toml.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "silpose/calibrate/board_for_test.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

constexpr Board kBoard{.columns = 8, .rows = 5, .square_m = 0.06};
constexpr int kCarried = 30, kOnFloor = 5;  // frames

PinholeCamera camera_at(const char* name, const Eigen::Vector3d& camera_centre, double focal) {
  PinholeCamera camera = look_at_camera(480, 360, focal, camera_centre, {0, 0.45, 0});
  camera.name = name;
  camera.cx += 4;
  camera.distortion = {-0.15, 0.04, 0.001, 0.0005, 0};
  return camera;
}

void film(const std::filesystem::path& folder) {
  const std::vector<PinholeCamera> cameras = {camera_at("left", {-0.5, 1.3, 1.9}, 430),
                                              camera_at("right", {0.7, 1.5, 1.8}, 450)};
  const Eigen::Vector3d between = (cameras[0].centre_in_world() + cameras[1].centre_in_world()) / 2;
  Rng rng(17);
  std::vector<Rigid3> places;
  for (int i = 0; i < kCarried; ++i) {
    const Eigen::Vector3d middle(rng.uniform(-0.35, 0.35), rng.uniform(0.3, 0.85), rng.uniform(-0.1, 0.75));
    const Eigen::Vector3d turn(rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), rng.uniform(-0.4, 0.4));
    places.push_back(board_towards(kBoard, middle, between, turn));
  }
  places.insert(places.end(), kOnFloor, board_on_floor(kBoard, 0, 0.2));
  for (const PinholeCamera& camera : cameras) {
    const BoardFilm scene(camera);
    VideoWriter video = create_video(folder / (camera.name + ".mp4"), camera.width, camera.height, 25).value();
    for (const Rigid3& place : places) video.write(scene.image(kBoard, place, rng)).value();
    video.close().value();
  }
  write_cameras(folder / "truth.toml", cameras).value();
}

}  // namespace
}  // namespace silpose

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: film_board FOLDER\n", stderr), 2;
  silpose::film(argv[1]);
  return 0;
}
