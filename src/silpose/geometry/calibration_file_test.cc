#include "silpose/geometry/calibration_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace silpose {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CalibrationFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("calibration_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  Result<Calibration> load(const std::string& text, const CalibrationOptions& options = {}) {
    std::ofstream(path_) << text;
    return load_calibration(path_, options);
  }

  // The camera below with one line replaced (or left out where `line` is empty).
  static std::string camera_with(const std::string& key, const std::string& line) {
    std::string text = "[left]\n";
    for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{
             {"name", "\"left one\""},
             {"size", "[640, 480]"},
             {"matrix", "[[500.0, 0.0, 319.5], [0.0, 510.0, 239.5], [0.0, 0.0, 1.0]]"},
             {"distortions", "[-0.1, 0.2, 0.01, 0.02]"},
             {"rotation", "[3.141592653589793, 0, 0]"},
             {"translation", "[0.0, 1.5, 5.5]"},
             {"fisheye", "false"}}) {
      if (name != key) {
        text += fmt::format("{} = {}\n", name, value);
      } else if (!line.empty()) {
        text += fmt::format("{} = {}\n", name, line);
      }
    }
    return text;
  }

  std::filesystem::path path_;
};

const std::string kYUpMetres = "[metadata]\nup = \"y\"\nunit = \"m\"\n";

TEST_F(CalibrationFile, ReadsACameraAndShiftsPixelsByHalf) {
  const auto calibration = load(camera_with("", "") + kYUpMetres).value();
  ASSERT_EQ(calibration.cameras.size(), 1U);
  EXPECT_FALSE(calibration.up_assumed);
  EXPECT_TRUE(calibration.warnings.empty());
  const PinholeCamera& camera = calibration.cameras[0];
  EXPECT_EQ(camera.name, "left one");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 500);
  EXPECT_EQ(camera.fy, 510);
  EXPECT_EQ(camera.cx, 320);
  EXPECT_EQ(camera.cy, 240);
  EXPECT_THAT(camera.distortion, testing::ElementsAre(-0.1, 0.2, 0.01, 0.02, 0));
  // Half a turn about x: the camera looks along -Z and is at (0, 1.5, 5.5).
  EXPECT_TRUE(camera.centre_in_world().isApprox(Eigen::Vector3d(0, 1.5, 5.5), 1e-12));
  EXPECT_TRUE(camera.project({0, 1.5, 0})->isApprox(Eigen::Vector2d(320, 240), 1e-12));
}

TEST_F(CalibrationFile, RoundTripKeepsEverything) {
  std::vector<PinholeCamera> cameras = {look_at_camera(640, 480, 700, {1, 1.7, 5}, {0, 1, 0}),
                                        default_camera(1920, 1080),
                                        look_at_camera(1000, 1002, 900, {-3, 2, -4}, {0, 0, 0})};
  cameras[0].name = "zulu \"north\"\\\n";
  cameras[0].distortion = {-0.1, 0.02, 0.001, -0.002, 0.3};
  cameras[1].name = "alpha";
  cameras[1].distortion = {0.1, 1e-9, 0, 0, 0};
  cameras[2].name = "mike";
  ASSERT_TRUE(write_cameras(path_, cameras).ok());
  const auto calibration = load_calibration(path_).value();
  EXPECT_FALSE(calibration.up_assumed);
  EXPECT_TRUE(calibration.warnings.empty());
  ASSERT_EQ(calibration.cameras.size(), 3U);
  for (size_t c = 0; c < 3; ++c) {
    const PinholeCamera &written = cameras[c], &read = calibration.cameras[c];
    EXPECT_EQ(read.name, written.name);
    EXPECT_EQ(read.width, written.width);
    EXPECT_EQ(read.height, written.height);
    EXPECT_EQ(read.fx, written.fx);
    EXPECT_EQ(read.fy, written.fy);
    EXPECT_NEAR(read.cx, written.cx, 1e-12);
    EXPECT_NEAR(read.cy, written.cy, 1e-12);
    EXPECT_EQ(read.distortion, written.distortion);
    EXPECT_LT((read.cam_from_world.rotation - written.cam_from_world.rotation).norm(), 1e-12);
    EXPECT_EQ(read.cam_from_world.translation, written.cam_from_world.translation);
  }
}

// A camera 5 m from the origin that looks horizontally in a world with the given up axis, rolled by `roll` radians.
std::string level_camera(const std::string& name, const Eigen::Vector3d& up, const Eigen::Vector3d& forward,
                         double roll = 0) {
  Eigen::Matrix3d rotation;
  rotation.row(0) = forward.cross(up);
  rotation.row(1) = -up;
  rotation.row(2) = forward;
  rotation = Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * rotation;
  const Eigen::AngleAxisd turn(rotation);
  const Eigen::Vector3d r = turn.angle() * turn.axis();
  return fmt::format(
      "[{}]\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0]\n"
      "rotation = [{:.17g}, {:.17g}, {:.17g}]\ntranslation = [0, 0, 5]\n",
      name, r.x(), r.y(), r.z());
}

TEST_F(CalibrationFile, TurnsAZUpWorld) {
  // The file's (x, y, z) is our (x, z, -y): what is at z = 1 in the file is at y = 1 here.
  const auto text = level_camera("a", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY());
  for (const auto& said : {std::string("[metadata]\nup = \"z\"\n"), std::string()}) {
    const auto calibration = load(text + said).value();
    EXPECT_EQ(calibration.up, UpAxis::kZ);
    EXPECT_EQ(calibration.up_assumed, said.empty());
    EXPECT_EQ(calibration.warnings.size(), said.empty() ? 1U : 0U);
    EXPECT_FALSE(calibration.up_reversed);
    const PinholeCamera& camera = calibration.cameras[0];
    EXPECT_TRUE(camera.centre_in_world().isApprox(Eigen::Vector3d(0, 0, 5), 1e-9));
    EXPECT_TRUE(camera.project({0, 1, 0})->isApprox(Eigen::Vector2d(320.5, 140.5), 1e-9));
    EXPECT_TRUE(camera.project({1, 0, 0})->isApprox(Eigen::Vector2d(420.5, 240.5), 1e-9));
  }
}

TEST_F(CalibrationFile, DeterminesTheUpAxisFromTheMeanOfRolledCameras) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ(), x = Eigen::Vector3d::UnitX();
  const auto y_up =
      load(level_camera("a", y, z, 0.5) + level_camera("b", y, -z, 0.4) + level_camera("c", y, x)).value();
  EXPECT_EQ(y_up.up, UpAxis::kY);
  EXPECT_TRUE(y_up.up_assumed);
  const auto z_up = load(level_camera("a", z, y, -0.6) + level_camera("b", z, -x, 0.6)).value();
  EXPECT_EQ(z_up.up, UpAxis::kZ);
  EXPECT_THAT(z_up.warnings[0], AllOf(HasSubstr(path_.string()), HasSubstr("z assumed")));
}

TEST_F(CalibrationFile, TurnsOverAWorldThatPointsDown) {
  // A world fixed to its first camera: x right, y down, z forward.
  const auto down = load(level_camera("a", -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ())).value();
  EXPECT_EQ(down.up, UpAxis::kY);
  EXPECT_TRUE(down.up_reversed);
  EXPECT_LT(down.cameras[0].project({0, 1, 0})->y(), 240);
  EXPECT_NEAR(down.cameras[0].cam_from_world.rotation.determinant(), 1, 1e-9);
  const auto z_down = load(level_camera("a", -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX())).value();
  EXPECT_EQ(z_down.up, UpAxis::kZ);
  EXPECT_LT(z_down.cameras[0].project({0, 1, 0})->y(), 240);
  EXPECT_NEAR(z_down.cameras[0].cam_from_world.rotation.determinant(), 1, 1e-9);
}

TEST_F(CalibrationFile, WarnsWhereTheUpDirectionIsNotClear) {
  const auto text = level_camera("a", Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), kPi / 2);
  EXPECT_EQ(load(text).value().warnings.size(), 2U);
}

TEST_F(CalibrationFile, OptionsOverrideTheFile) {
  const auto text = level_camera("a", Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitY()) + kYUpMetres;
  const auto calibration = load(text, {.up = UpAxis::kZ, .metres_per_unit = 0.5}).value();
  EXPECT_EQ(calibration.up, UpAxis::kZ);
  EXPECT_FALSE(calibration.up_assumed);
  EXPECT_TRUE(calibration.cameras[0].centre_in_world().isApprox(Eigen::Vector3d(0, 0, 2.5), 1e-9));
  EXPECT_THROW((void)load(text, {.up = {}, .metres_per_unit = -1}), std::invalid_argument);
}

TEST_F(CalibrationFile, ReadsMillimetresAndSuspectsThem) {
  const auto text = camera_with("translation", "[0, 1500, 5500]");
  EXPECT_TRUE(load(text + "[metadata]\nunit = \"mm\"\n")
                  .value()
                  .cameras[0]
                  .centre_in_world()
                  .isApprox(Eigen::Vector3d(0, 1.5, 5.5), 1e-9));
  EXPECT_THAT(load(text + "[metadata]\nup = \"y\"\n").value().warnings[0], HasSubstr("does not say its unit"));
}

TEST_F(CalibrationFile, IgnoresOtherTablesAndKeysAndKeepsFileOrder) {
  const auto calibration =
      load("version = 3\n" + level_camera("zebra", Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()) +
           "grid_count = 12\nerror = nan\n[capture_volume]\nstage = 1\nsize = [1, 2]\n" +
           level_camera("ape", Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()) + "[metadata]\nadjusted = false\n")
          .value();
  ASSERT_EQ(calibration.cameras.size(), 2U);
  EXPECT_EQ(calibration.cameras[0].name, "zebra");
  EXPECT_EQ(calibration.cameras[1].name, "ape");
}

TEST_F(CalibrationFile, NamesFileCameraAndKeyOfBadInput) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"size", "", "size is missing"},
      {"size", "[640]", "size has 1 entries, not 2"},
      {"size", "[640, -480]", "size is not [width, height]"},
      {"size", "[640, 480.5]", "size is not [width, height]"},
      {"matrix", "", "matrix is missing"},
      {"matrix", "[[500, 0, 320], [0, 500, 240]]", "matrix is not a list of 3 rows"},
      {"matrix", "[[500, 0, nan], [0, 500, 240], [0, 0, 1]]", "matrix row 1 holds something that is not a finite"},
      {"matrix", "[[0, 0, 320], [0, 500, 240], [0, 0, 1]]", "focal length is not positive"},
      {"matrix", "[[500, 1, 320], [0, 500, 240], [0, 0, 1]]", "skew"},
      {"matrix", "[[500, 0, 320], [0, 500, 240], [0, 0, 2]]", "not a camera matrix"},
      {"distortions", "", "distortions is missing"},
      {"distortions", "[0.1, 0.2]", "distortions has 2 entries, not 4 to 5"},
      {"distortions", "[0.1, 0.2, inf, 0]", "distortions holds something that is not a finite number"},
      {"rotation", "", "rotation is missing"},
      {"rotation", "[0, 0, \"a\"]", "rotation holds something that is not a finite number"},
      {"rotation", "3", "rotation is not a list"},
      {"rotation", "[0, 1e200, 0]", "rotation is not a rotation vector in radians"},
      {"translation", "", "translation is missing"},
      {"translation", "[1, 2, 3, 4]", "translation has 4 entries, not 3"},
      {"translation", "[1, true, 3]", "translation holds something that is not a finite number"},
      {"name", "\"left one/../x\"", "a name has no /"},
      {"size", "[20000, 480]", "whole pixels, 1 to 16384"},
      {"fisheye", "true", "fisheye cameras are not supported"},
      {"fisheye", "1", "fisheye is not true or false"}};
  for (const auto& [key, line, message] : cases) {
    const auto calibration = load(camera_with(key, line));
    ASSERT_FALSE(calibration.ok()) << key << " = " << line;
    EXPECT_THAT(calibration.error().message,
                AllOf(HasSubstr(path_.string()), HasSubstr("left one"), HasSubstr(message)));
  }
}

TEST_F(CalibrationFile, RefusesFilesThatAreNotCalibrations) {
  EXPECT_THAT(load_calibration("no/such.toml").error().message, HasSubstr("no/such.toml: no such file"));
  EXPECT_THAT(load("").error().message, HasSubstr("holds no camera"));
  EXPECT_THAT(load("[metadata]\nup = \"y\"\n").error().message, HasSubstr("holds no camera"));
  EXPECT_THAT(load("[left]\nsize = [1, \n\nrotation = 3").error().message, HasSubstr("not TOML"));
  EXPECT_THAT(load(std::string("\x00\xff\xfe", 3)).error().message, HasSubstr("not TOML"));
  EXPECT_THAT(load(camera_with("", "") + "[metadata]\nup = \"x\"\n").error().message, HasSubstr("[metadata] up"));
  EXPECT_THAT(load(camera_with("", "") + "[metadata]\nunit = 3\n").error().message, HasSubstr("[metadata] unit"));
  EXPECT_THAT(
      load(camera_with("", "") + "[right]\nname = \"left one\"\n" + camera_with("name", "").substr(7)).error().message,
      HasSubstr("two cameras are named 'left one'"));
}

TEST_F(CalibrationFile, SaysWhereItCannotWrite) {
  EXPECT_THAT(write_cameras("no/such/cameras.toml", {default_camera(64, 48)}).error().message,
              HasSubstr("no/such/cameras.toml: cannot be written"));
}

}  // namespace
}  // namespace silpose
