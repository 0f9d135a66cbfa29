#include "silpose/calibrate/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "silpose/calibrate/board_for_test.h"

namespace silpose {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr Board kBoard{.columns = 9, .rows = 6, .square_m = 0.06};

PinholeCamera lens(const Eigen::Vector3d& camera_centre, double focal, const char* name) {
  PinholeCamera camera = look_at_camera(640, 480, focal, camera_centre, {0, 0.4, 0});
  camera.fy = 1.01 * focal;
  camera.cx += 7;
  camera.cy -= 5;
  camera.distortion = {-0.18, 0.06, 0.001, -0.0015, 0};
  camera.name = name;
  return camera;
}

// Where a board is carried around a room, print towards the first camera, somewhere in its image; instant 0: on the
// floor.
std::vector<Rigid3> walk(const PinholeCamera& camera, int count, double tilt, Rng& rng) {
  std::vector<Rigid3> places = {board_on_floor(kBoard, 0.1, 0.3)};
  for (int i = 1; i < count; ++i) {
    const Eigen::Vector3d ray = camera.ray_from_pixel({rng.uniform(120, 520), rng.uniform(90, 390)});
    const Eigen::Vector3d middle = camera.cam_from_world.inverse() * Eigen::Vector3d(rng.uniform(0.9, 2.2) * ray);
    const Eigen::Vector3d turn(rng.uniform(-tilt, tilt), rng.uniform(-tilt, tilt), rng.uniform(-0.4, 0.4));
    places.push_back(board_towards(kBoard, middle, camera.centre_in_world(), turn));
  }
  return places;
}

// The corners as a detector gives them, half a tenth of a pixel off; nothing where the board is not whole in view or
// seen from behind.
CameraSightings watch(const PinholeCamera& camera, const std::vector<Rigid3>& places, Rng& rng, double noise = 0.05) {
  CameraSightings seen{.name = camera.name, .width = camera.width, .height = camera.height};
  for (size_t i = 0; i < places.size(); ++i) {
    Sighting sighting{.instant = static_cast<int64_t>(i)};
    const Rigid3 cam_from_board = camera.cam_from_world * places[i];
    if (cam_from_board.rotation.col(2).dot(cam_from_board.translation) <= 0) continue;
    for (const Eigen::Vector3d& point : board_points(kBoard)) {
      const auto pixel = camera.project(places[i] * point);
      if (!pixel || pixel->x() < 5 || pixel->y() < 5 || pixel->x() > 635 || pixel->y() > 475) break;
      sighting.corners.push_back(*pixel + noise * Eigen::Vector2d(rng.normal(), rng.normal()));
    }
    if (sighting.corners.size() == board_points(kBoard).size()) seen.sightings.push_back(std::move(sighting));
  }
  return seen;
}

void expect_same_lens(const PinholeCamera& found, const PinholeCamera& truth, double tolerance) {
  EXPECT_NEAR(found.fx / truth.fx, 1, tolerance);
  EXPECT_NEAR(found.fy / truth.fy, 1, tolerance);
  EXPECT_NEAR(found.cx, truth.cx, 3);
  EXPECT_NEAR(found.cy, truth.cy, 3);
  // What the coefficients do, not what they are: how they bend what is seen near the image's rims. (A shift of all of
  // it is hardly distinguishable from a rotation of the camera.)
  std::vector<Eigen::Vector2d> off;
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(0.1, 0.5), {0.9, 0.5}, {0.5, 0.1}, {0.5, 0.9}}) {
    const Eigen::Vector2d pixel(place.x() * truth.width, place.y() * truth.height);
    off.push_back(found.project_from_camera(truth.ray_from_pixel(pixel)) - pixel);
  }
  const Eigen::Vector2d shift = (off[0] + off[1] + off[2] + off[3]) / 4;
  for (const Eigen::Vector2d& one : off) EXPECT_LT((one - shift).norm(), 0.7);
}

// Of one world in another: both have the floor at y = 0, but place and heading are a convention.
double distance_between(const PinholeCamera& a, const PinholeCamera& b) {
  return (a.centre_in_world() - b.centre_in_world()).norm();
}

TEST(CalibrateTest, ACameraFromImagesOfABoard) {
  const PinholeCamera full = lens({0, 1.5, 2.2}, 620, "cam"), truth = full.resized(480, 360);
  const BoardFilm film(truth);
  Rng rng(11);
  const auto places = walk(full, 12, 0.6, rng);
  CameraSightings seen{.name = "cam", .width = 480, .height = 360};
  for (size_t i = 0; i < places.size(); ++i) {
    auto corners = find_board(film.image(kBoard, places[i], rng), kBoard);
    if (corners) seen.sightings.push_back({static_cast<int64_t>(i), std::move(*corners)});
  }
  ASSERT_GE(seen.sightings.size(), 8);
  const auto found = calibrate_cameras(kBoard, {seen}, 0);
  ASSERT_TRUE(found) << found.error().message;
  expect_same_lens(found->cameras[0], truth, 0.005);
  EXPECT_LT(found->rms_px, 0.2);
  // The board lies at (0.1, 0, 0.3), along the world's axes.
  EXPECT_LT((found->cameras[0].centre_in_world() - (truth.centre_in_world() - Eigen::Vector3d(0.1, 0, 0.3))).norm(),
            0.01);
  EXPECT_GT((found->cameras[0].cam_from_world.rotation.transpose() * truth.cam_from_world.rotation).trace(), 2.9999);
}

TEST(CalibrateTest, CamerasStandWhereTheyStand) {
  const std::vector<PinholeCamera> truth = {lens({0, 1.6, 2.4}, 600, "left"), lens({1.6, 1.4, 1.8}, 640, "middle"),
                                            lens({2.4, 1.5, 0.6}, 580, "right")};
  Rng rng(3);
  // Carried in front of each camera in turn: the outer two hardly ever see it together.
  std::vector<Rigid3> places;
  for (const PinholeCamera& camera : truth) {
    const auto more = walk(camera, 16, 0.6, rng);
    places.insert(places.end(), more.begin() + (places.empty() ? 0 : 1), more.end());
  }
  std::vector<CameraSightings> seen;
  for (const PinholeCamera& camera : truth) seen.push_back(watch(camera, places, rng));
  const auto found = calibrate_cameras(kBoard, seen, 0);
  ASSERT_TRUE(found) << found.error().message;
  for (size_t c = 0; c < truth.size(); ++c) {
    expect_same_lens(found->cameras[c], truth[c], 0.003);
    EXPECT_NEAR(distance_between(found->cameras[c], found->cameras[0]), distance_between(truth[c], truth[0]), 0.005);
    EXPECT_NEAR(found->cameras[c].centre_in_world().y(), truth[c].centre_in_world().y(), 0.005);
    EXPECT_LT(found->fits[c].rms_px, 0.1);
  }
  EXPECT_TRUE(found->warnings.empty()) << found->warnings[0];
}

TEST(CalibrateTest, AViewThatContradictsTheOthersIsLeftOut) {
  const std::vector<PinholeCamera> truth = {lens({0, 1.6, 2.4}, 600, "left"), lens({1, 1.4, 2.2}, 640, "right")};
  Rng rng(4);
  const auto places = walk(truth[0], 30, 0.6, rng);
  std::vector<CameraSightings> seen = {watch(truth[0], places, rng), watch(truth[1], places, rng)};
  for (size_t v = 5; v < seen[1].sightings.size(); v += 9) {  // found upside down
    std::reverse(seen[1].sightings[v].corners.begin(), seen[1].sightings[v].corners.end());
  }
  const auto found = calibrate_cameras(kBoard, seen, 0);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_LT(found->rms_px, 0.1);
  EXPECT_NEAR(distance_between(found->cameras[1], found->cameras[0]), distance_between(truth[1], truth[0]), 0.005);
}

TEST(CalibrateTest, WithoutAFloorTheFirstCameraIsLevelAndThatIsSaid) {
  const std::vector<PinholeCamera> truth = {lens({0, 1.6, 2.4}, 600, "left"), lens({1, 1.4, 2.2}, 640, "right")};
  Rng rng(5);
  const auto places = walk(truth[0], 25, 0.6, rng);
  const auto found =
      calibrate_cameras(kBoard, {watch(truth[0], places, rng), watch(truth[1], places, rng)}, std::nullopt);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->cameras[0].centre_in_world().y(), 1.5, 1e-9);
  EXPECT_NEAR(found->cameras[0].cam_from_world.rotation(1, 1), -1, 1e-9);
  EXPECT_NEAR(distance_between(found->cameras[1], found->cameras[0]), distance_between(truth[1], truth[0]), 0.005);
  EXPECT_THAT(found->warnings, Contains(AllOf(HasSubstr("floor"), HasSubstr("left"), HasSubstr("level"))));
}

TEST(CalibrateTest, ViewsThatDoNotTellEnoughAreNamed) {
  const PinholeCamera truth = lens({0, 1.6, 2.4}, 600, "cam");
  Rng rng(6);
  const auto seen = watch(truth, walk(truth, 9, 0.02, rng), rng, 0.3);  // always head-on
  const auto vague = calibrate_cameras(kBoard, {seen}, std::nullopt);
  ASSERT_TRUE(vague) << vague.error().message;
  EXPECT_THAT(vague->warnings, Contains(AllOf(HasSubstr("cam"), HasSubstr("focal length"))));
  EXPECT_THAT(vague->warnings, Contains(AllOf(HasSubstr("cam"), HasSubstr("only"), HasSubstr("views"))));

  CameraSightings one_place = seen;
  one_place.sightings.assign(20, seen.sightings[1]);
  const auto too_few = calibrate_cameras(kBoard, {one_place}, std::nullopt);
  ASSERT_FALSE(too_few);
  EXPECT_THAT(too_few.error().message, AllOf(HasSubstr("cam"), HasSubstr("1 views"), HasSubstr("20 frames")));
}

TEST(CalibrateTest, ACornerInTheWrongPlaceShowsInTheError) {
  const PinholeCamera truth = lens({0, 1.6, 2.4}, 600, "cam");
  Rng rng(7);
  const auto found = calibrate_cameras(kBoard, {watch(truth, walk(truth, 25, 0.6, rng), rng, 1.5)}, 0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->fits[0].rms_px, 1.5 * std::sqrt(2), 0.15);
  EXPECT_THAT(found->warnings, Contains(HasSubstr("cam: corners are")));
}

TEST(CalibrateTest, CamerasThatShareNothingAreNamed) {
  const PinholeCamera a = lens({0, 1.6, 2.4}, 600, "left"), b = lens({0, 1.6, -2.4}, 600, "right");
  Rng rng(8);
  const CameraSightings of_a = watch(a, walk(a, 12, 0.6, rng), rng);
  CameraSightings of_b = watch(b, walk(b, 12, 0.6, rng), rng);
  for (Sighting& sighting : of_b.sightings) sighting.instant += 1000;
  const auto found = calibrate_cameras(kBoard, {of_a, of_b}, std::nullopt);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, AllOf(HasSubstr("left"), HasSubstr("right"), HasSubstr("together")));
}

TEST(CalibrateTest, ABoardThatLooksTheSameUpsideDownIsForOneCamera) {
  EXPECT_THROW((void)calibrate_cameras({.columns = 8, .rows = 6}, {{}, {}}, std::nullopt), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
