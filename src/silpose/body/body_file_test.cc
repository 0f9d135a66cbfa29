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
  const std::string good = written();
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
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace silpose
