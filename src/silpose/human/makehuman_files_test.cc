#include "silpose/human/makehuman_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace silpose {
namespace {

using testing::HasSubstr;

TEST(MakeHumanTarget, ReadsShortNumbers) {
  const MakeHumanTarget target = parse_makehuman_target("t", "0 .031 -1.5 -.156\n19157 1 2 -3\n\n").value();
  ASSERT_EQ(target.vertex_idx, (std::vector<uint32_t>{0, 19157}));
  EXPECT_EQ(target.offset[0], Eigen::Vector3f(.031f, -1.5f, -.156f));
  EXPECT_EQ(target.offset[1], Eigen::Vector3f(1, 2, -3));
  EXPECT_TRUE(parse_makehuman_target("t", "").value().offset.empty());
}

TEST(MakeHumanTarget, RefusesMalformedLines) {
  for (const char* text : {"19158 0 0 0\n", "-1 0 0 0\n", "3 0 0\n", "a 0 0 0\n", "3 0 x 0"}) {
    const Result<MakeHumanTarget> target = parse_makehuman_target("bad.target", text);
    ASSERT_FALSE(target) << text;
    EXPECT_THAT(target.error().message, HasSubstr("bad.target: line 1"));
  }
}

TEST(MakeHumanMesh, RefusesOtherMeshes) {
  EXPECT_FALSE(parse_makehuman_mesh("m", "v 0 0 0\n"));
  EXPECT_FALSE(parse_makehuman_mesh("m", "v 0 0\n"));
  EXPECT_FALSE(parse_makehuman_mesh("m", "v 0 0 0\ng body\nf 1 1 1 2\n"));
}

TEST(MakeHumanWeights, RefusesMalformedJson) {
  const std::map<std::string, int> joints = {{"root", 0}};
  const std::string rig = R"({"root": {"parent": ""}, "hand": {"parent": "root"}, "lost": {"parent": "lost"}})";
  EXPECT_FALSE(parse_makehuman_weights("w", rig, "nothing", joints));
  EXPECT_FALSE(parse_makehuman_weights("w", rig, R"({"weights": {"hand": [[0]]}})", joints));
  const Result<SkinWeights> lost = parse_makehuman_weights("w", rig, R"({"weights": {"lost": [[0, 1]]}})", joints);
  EXPECT_THAT(lost.error().message, HasSubstr("lost"));
  const Result<SkinWeights> few = parse_makehuman_weights("w", rig, R"({"weights": {"hand": [[0, 1]]}})", joints);
  EXPECT_THAT(few.error().message, HasSubstr("vertex 1 has no weight"));
}

TEST(Gunzip, RefusesDamage) {
  EXPECT_FALSE(gunzip("z", "no gzip here", 1000));
  EXPECT_FALSE(gunzip("z", "", 1000));
}

}  // namespace
}  // namespace silpose
