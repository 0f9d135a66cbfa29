#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "silpose/base/rng.h"
#include "silpose/base/text_file.h"
#include "silpose/body/body_model.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

using testing::HasSubstr;

class BodyFile : public testing::Test {
 protected:
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".body");

  std::string written() {
    write_body(path, make_test_body()).value();
    return read_text_file(path).value();
  }
  std::string failure_of(const std::string& bytes) {
    write_text_file(path, bytes).value();
    const Result<BodyModel> body = load_body(path);
    return body ? "loaded" : body.error().message;
  }
  void TearDown() override { std::filesystem::remove(path); }
};

TEST_F(BodyFile, KeepsEverything) {
  BodyModel body = make_test_body();
  body.joint_from_rest[1].rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  write_body(path, body).value();
  const BodyModel again = load_body(path).value();
  EXPECT_EQ(again.name, body.name);
  EXPECT_EQ(again.facts, body.facts);
  EXPECT_EQ(again.height_m, body.height_m);
  EXPECT_EQ(again.weight_kg, body.weight_kg);
  EXPECT_EQ(again.rest.vertices, body.rest.vertices);
  EXPECT_EQ(again.rest.faces, body.rest.faces);
  EXPECT_EQ(again.skin.row_start, body.skin.row_start);
  EXPECT_EQ(again.skin.joint_idx, body.skin.joint_idx);
  EXPECT_EQ(again.skin.weight, body.skin.weight);
  EXPECT_EQ(again.joint_from_rest[1].rotation, body.joint_from_rest[1].rotation);
  EXPECT_EQ(landmark_names(again), landmark_names(body));
  for (int d = 0; d < 8; ++d) {
    EXPECT_EQ(again.skeleton.dofs()[d].column(), body.skeleton.dofs()[d].column());
    EXPECT_EQ(again.skeleton.dofs()[d].lower, body.skeleton.dofs()[d].lower);
    EXPECT_EQ(again.skeleton.dofs()[d].is_periodic, body.skeleton.dofs()[d].is_periodic);
  }
  const std::vector<double> pose = {.1, .2, .3, .4, .5, .6, .7, .8};
  EXPECT_EQ(skin_vertices(again, pose), skin_vertices(body, pose));
  EXPECT_EQ(landmark_positions(again, pose), landmark_positions(body, pose));
}

// Two levels of the test body: its own mesh, and one that leaves a vertex out.
BodyModel body_with_levels() {
  BodyModel body = make_test_body();
  BodyLevel whole{.asked_vertices = 200, .vertices = {}, .faces = body.rest.faces, .mean_iou = 1, .worst_iou = 1};
  for (uint32_t v = 0; v < body.rest.vertices.size(); ++v) whole.vertices.push_back(v);
  body.levels = {
      {.asked_vertices = 100, .vertices = {0, 1, 3}, .faces = {{0, 1, 2}}, .mean_iou = 0.5, .worst_iou = 0.25}, whole};
  return body;
}

TEST_F(BodyFile, KeepsLevels) {
  const BodyModel body = body_with_levels();
  write_body(path, body).value();
  const BodyModel again = load_body(path).value();
  ASSERT_EQ(again.levels.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.levels[i].asked_vertices, body.levels[i].asked_vertices);
    EXPECT_EQ(again.levels[i].vertices, body.levels[i].vertices);
    EXPECT_EQ(again.levels[i].faces, body.levels[i].faces);
    EXPECT_EQ(again.levels[i].mean_iou, body.levels[i].mean_iou);
    EXPECT_EQ(again.levels[i].worst_iou, body.levels[i].worst_iou);
  }
}

TEST_F(BodyFile, WithoutLevelsIsWhatOlderProgramsRead) {
  EXPECT_EQ(written()[8], 1);
  write_body(path, body_with_levels()).value();
  std::string bytes = read_text_file(path).value();
  EXPECT_EQ(bytes[8], 2);
  bytes[8] = 3;
  EXPECT_THAT(failure_of(bytes), HasSubstr("version 3"));
}

TEST_F(BodyFile, RefusesLevelsOfAnotherMesh) {
  const auto refusal = [&](const auto& change) {
    BodyModel body = body_with_levels();
    change(body.levels[0]);
    write_body(path, body).value();
    return load_body(path).error().message;
  };
  EXPECT_THAT(refusal([](BodyLevel& level) { level.vertices[2] = 9999; }), HasSubstr("not the body's"));
  EXPECT_THAT(refusal([](BodyLevel& level) { level.vertices[1] = 0; }), HasSubstr("not the body's"));
  EXPECT_THAT(refusal([](BodyLevel& level) { level.faces[0][1] = 3; }), HasSubstr("level's face"));
  EXPECT_THAT(refusal([](BodyLevel& level) { level.mean_iou = 1.5; }), HasSubstr("overlap"));
  EXPECT_THAT(refusal([](BodyLevel& level) { level.faces.clear(); }), HasSubstr("no faces"));
}

TEST_F(BodyFile, SaysWhatIsWrong) {
  const std::string good = written();
  EXPECT_THAT(load_body("nowhere/none.body").error().message, HasSubstr("nowhere/none.body"));
  EXPECT_THAT(failure_of(""), HasSubstr("empty"));
  EXPECT_THAT(failure_of("not a body at all, but some text"), HasSubstr("not a body file"));
  EXPECT_THAT(failure_of(good.substr(0, 12)), HasSubstr("truncated"));
  EXPECT_THAT(failure_of(good.substr(0, good.size() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(failure_of(good + "x"), HasSubstr("damaged"));
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  EXPECT_THAT(failure_of(flipped), HasSubstr("damaged"));
  std::string newer = good;
  newer[8] = 9;
  EXPECT_THAT(failure_of(newer), HasSubstr("version 9"));
  EXPECT_THAT(failure_of(newer), HasSubstr(path.string()));
}

// CRC-32 as the standard defines it, bit by bit.
uint32_t crc32_of(const std::string& bytes) {
  uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

TEST_F(BodyFile, SurvivesHostileContentWithARightChecksum) {
  write_body(path, body_with_levels()).value();
  const std::string good = read_text_file(path).value();
  Rng rng(11);
  int refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string payload = good.substr(24);
    for (int k = 0; k < 3; ++k) {
      payload[rng.index(payload.size())] = static_cast<char>(rng.uniform() < 0.5 ? 0xff : rng.index(256));
    }
    std::string bytes = good.substr(0, 24);
    const uint32_t crc = crc32_of(payload);
    std::memcpy(bytes.data() + 12, &crc, 4);
    std::ofstream(path, std::ios::binary) << bytes << payload;
    const Result<BodyModel> body = load_body(path);  // must not crash nor take all memory
    if (!body) {
      EXPECT_THAT(body.error().message, HasSubstr("malformed"));
      ++refused;
    } else {
      (void)skin_vertices(*body, std::vector<double>(body->skeleton.dofs().size()));
      for (const BodyLevel& level : body->levels) (void)body_of_level(*body, level);
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace silpose
