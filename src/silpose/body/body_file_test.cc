#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "silpose/base/checked_file.h"
#include "silpose/base/rng.h"
#include "silpose/base/text_file.h"
#include "silpose/body/body_model.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/stretchable.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

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

TEST_F(BodyFile, KeepsTheRig) {
  BodyModel body = make_rotations_first_body();
  body.profile.facing = Eigen::Vector3d(0, -1, 0);
  body.profile.limbs = {{{1}, {1, 2}}, {{2}, {3, 4}}};
  body.profile.limb_pairs = {{1, 0}};
  body.profile.across = {{2, 1}};
  body.profile.contact_joints = {2};
  body.profile.landmarks[1].other_names = {{"openpose", "MidHip"}, {"keypoints", "hip"}};
  write_body(path, body).value();
  const BodyModel again = load_body(path).value();
  EXPECT_EQ(again.skeleton.joints()[0].parent_from_rest, body.skeleton.joints()[0].parent_from_rest);
  const RigProfile &kept = again.profile, &given = body.profile;
  EXPECT_EQ(kept.root_translations, given.root_translations);
  EXPECT_EQ(kept.heading, given.heading);
  EXPECT_EQ(kept.up, given.up);
  EXPECT_EQ(kept.facing, given.facing);
  ASSERT_EQ(kept.limbs.size(), 2u);
  EXPECT_EQ(kept.limbs[1].joints, given.limbs[1].joints);
  EXPECT_EQ(kept.limbs[1].dofs, given.limbs[1].dofs);
  ASSERT_EQ(kept.limb_pairs.size(), 1u);
  EXPECT_EQ(kept.limb_pairs[0].right, 1u);
  EXPECT_EQ(kept.limb_pairs[0].left, 0u);
  EXPECT_EQ(kept.across[0].right, 2);
  EXPECT_EQ(kept.across[0].left, 1);
  EXPECT_EQ(kept.contact_joints, given.contact_joints);
  ASSERT_EQ(kept.landmarks.size(), given.landmarks.size());
  EXPECT_EQ(kept.landmarks[1].other_names, given.landmarks[1].other_names);
  EXPECT_EQ(kept.landmarks[3].name, "tip_end");
  EXPECT_EQ(kept.origin, given.origin);
  EXPECT_EQ(kept.noise, given.noise);
  EXPECT_EQ(kept.acceleration, given.acceleration);
  EXPECT_EQ(kept.rest, given.rest);
  EXPECT_EQ(kept.rest_if_seen, given.rest_if_seen);
  ASSERT_EQ(kept.poses.size(), given.poses.size());
  EXPECT_EQ(kept.poses.back().name, given.poses.back().name);
  EXPECT_EQ(kept.poses.back().pose, given.poses.back().pose);
  EXPECT_EQ(kept.silhouette_area, given.silhouette_area);
  EXPECT_TRUE(again.skeleton.dofs()[7].is_bounded);
  const std::vector<double> pose = {.1, .2, .3, .4, .5, .6, .7, .8};
  EXPECT_EQ(skin_vertices(again, pose), skin_vertices(body, pose));
}

TEST_F(BodyFile, KeepsShapeDofs) {
  const BodyModel body = stretchable(make_test_body());
  write_body(path, body).value();
  EXPECT_EQ(shape_dofs(load_body(path).value().skeleton), shape_dofs(body.skeleton));
  EXPECT_FALSE(shape_dofs(body.skeleton).empty());
}

TEST_F(BodyFile, ReadsOlderVersionsAndDerivesTheirRig) {
  // Version 1 ended after the last fact, version 2 after the levels.
  const auto payload_of = [&](const BodyModel& body) {
    write_body(path, body).value();
    return read_text_file(path).value().substr(24);
  };
  const auto cut = [&](const BodyModel& body) {
    const std::string payload = payload_of(body), last_fact = body.facts.rbegin()->second;
    return payload.substr(0, payload.rfind(last_fact) + last_fact.size());
  };
  const auto load = [&](uint32_t version, const std::string& payload) {
    write_checked_file(path, {.magic = "SILPBODY", .version = version, .name = "body file"}, payload).value();
    return load_body(path).value();
  };
  const BodyModel tube = make_test_body();
  const std::string first = cut(tube);
  const size_t rig_size = payload_of(tube).size() - first.size() - 4;  // without the count of levels
  const std::string with_levels = payload_of(body_with_levels());
  const std::string second = with_levels.substr(0, with_levels.size() - rig_size);
  for (const auto& [version, payload, levels] : {std::tuple(1u, first, 0u), {2u, second, 2u}}) {
    const BodyModel again = load(version, payload);
    EXPECT_EQ(again.levels.size(), levels);
    EXPECT_EQ(again.profile.noise, tube.profile.noise);
    EXPECT_EQ(again.profile.poses.size(), tube.profile.poses.size());
  }
  EXPECT_EQ(load(1, cut(*human_for_test(800))).profile.poses.size(), 17u);
  std::string newer = read_text_file(path).value();
  newer[8] = 4;
  EXPECT_THAT(failure_of(newer), HasSubstr("version 4"));
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
