// fuzz_seeds FOLDER: writes small valid files for every fuzz target to FOLDER/NAME, by the project's own writers.
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/text_file.h"
#include "silpose/body/test_body.h"
#include "silpose/exchange/bvh.h"
#include "silpose/exchange/tables.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/segment/tflite_bytes_for_test.h"
#include "tests/fuzz/checkpoint_state.h"
#include "tests/fuzz/fuzz_input.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

void write_bodies(const fs::path& folder) {
  BodyModel body = make_ball_body();
  write_body(folder / "body_file/plain", body).value();
  body.levels.push_back(
      {.asked_vertices = 3, .vertices = {0, 1, 2}, .faces = {Face{0, 1, 2}}, .mean_iou = 0.9, .worst_iou = 0.8});
  write_body(folder / "body_file/with_level", body).value();
}

void write_motions(const fs::path& folder) {
  const BodyModel body = make_test_body();
  const std::vector<std::vector<double>> poses = {{0, 0.5, 0, 0, 0, 0.2, 0, 0.1}, {0.1, 0.5, 0, 0.3, 0, 0.4, 0, 0.2}};
  write_bvh(folder / "bvh/tube", clip_from_poses(body.skeleton, poses, 30, body.end_points)).value();

  PoseTable table;
  for (size_t t = 0; t < poses.size(); ++t) {
    table.rows.push_back({.frame = static_cast<int64_t>(t), .time_s = static_cast<double>(t) / 30, .values = poses[t]});
  }
  write_poses(folder / "tables/poses", body.skeleton, table).value();
  JointTable joints;
  joints.rows = {{.frame = 0, .joint = "root"}, {.frame = 0, .joint = "tip"}, {.frame = 1, .joint = "root"}};
  joints.has_spread = true;
  write_joints(folder / "tables/joints", joints).value();

  // Two frames of 44 numbers: duration, root, then identity quaternions and straight hinges.
  std::string frame = "[0.02, 0, 0.9, 0";
  for (const char kind : std::string_view("qqqqhqqhqhqqh")) frame += kind == 'q' ? ", 1, 0, 0, 0" : ", 0";
  write_text_file(folder / "humanoid3d/standing",
                  fmt::format("{{\"Loop\": \"wrap\", \"Frames\": [{0}], {0}]]}}", frame))
      .value();
}

void write_cameras_and_points(const fs::path& folder) {
  write_cameras(folder / "calibration/two", {look_at_camera(320, 240, 300, {0, 1, 4}, {0, 1, 0}),
                                             look_at_camera(320, 240, 300, {4, 1, 0}, {0, 1, 0})})
      .value();
  write_text_file(
      folder / "ply/triangle",
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty uchar k\nproperty "
      "float y\nproperty float z\nend_header\n" +
          std::string(39, '\0'))
      .value();
}

void write_network(const fs::path& folder) {
  TfliteBytes bytes;
  const int in = bytes.tensor("in", {1, 6, 6, 2}), w = bytes.sparse({1, 1, 1, 2}, {1}, {0, 1}, {1});
  const int dense = bytes.tensor("dense", {1, 1, 1, 2}), b = bytes.constant<uint16_t>({1}, {0x3c00});
  const int wide = bytes.tensor("wide", {1}), out = bytes.tensor("out", {1, 3, 3, 1});
  bytes.add(TfliteOp::kDensify, {w}, dense);
  bytes.add(TfliteOp::kDequantize, {b}, wide);
  bytes.add(TfliteOp::kConv2d, {in, dense, wide}, out, {{1, 2}, {2, 2}});
  write_text_file(folder / "tflite/convolution", bytes.finish({in}, {out})).value();
}

void write_states_and_options(const fs::path& folder) {
  fuzz::State state;
  state.poses = {{0.1, 0.2}, {}};
  state.areas = {1, 2, 3};
  state.name = "walker";
  state.lines = {{"seed", "1"}};
  state.matrix = Eigen::MatrixXd::Identity(2, 3);
  state.vectors = {Eigen::VectorXd::Ones(2)};
  write_text_file(folder / "state_bytes/whole", to_bytes(state)).value();
  write_text_file(folder / "state_bytes/empty", to_bytes(fuzz::State{})).value();
  write_text_file(folder / "option_file/all", "number = 3\ntext = \"a\"\nlist = [1, 2.5]\nflag = true\n").value();
}

// The experiments themselves.
void copy_grids(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(SILPOSE_SOURCE_DIR "/experiments")) {
    if (entry.path().extension() == ".toml") fs::copy_file(entry.path(), folder / "grid" / entry.path().filename());
  }
}

}  // namespace
}  // namespace silpose

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::remove_all(folder);
  for (const char* name : {"body_file", "bvh", "tables", "humanoid3d", "calibration", "ply", "tflite", "state_bytes",
                           "option_file", "grid"}) {
    std::filesystem::create_directories(folder / name);
  }
  silpose::write_bodies(folder);
  silpose::write_motions(folder);
  silpose::write_cameras_and_points(folder);
  silpose::write_network(folder);
  silpose::write_states_and_options(folder);
  silpose::copy_grids(folder);
  return 0;
}
