#include "silpose/exchange/glb.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "silpose/base/rng.h"
#include "silpose/base/text_file.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

Eigen::Matrix4d matrix(const aiMatrix4x4& m) {
  return Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>>(&m.a1).cast<double>();
}

class Glb : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  static PoseTable random_poses(const Skeleton& skeleton, int num_frames) {
    PoseTable table;
    Rng rng(9);
    for (int frame = 0; frame < num_frames; ++frame) {
      PoseTable::Row row{.frame = 30 + frame, .time_s = 1 + 0.04 * frame};
      for (const Dof& dof : skeleton.dofs()) row.values.push_back(rng.uniform(dof.lower, dof.upper));
      table.rows.push_back(row);
    }
    return table;
  }

  const aiScene* read() {
    const aiScene* scene = importer_.ReadFile(path_.string(), aiProcess_ValidateDataStructure);
    EXPECT_NE(scene, nullptr) << importer_.GetErrorString();
    return scene;
  }

  // Where every node of the scene is in the world at a key of its animation.
  static std::map<std::string, Eigen::Matrix4d> nodes_at(const aiScene& scene, unsigned key) {
    std::map<std::string, const aiNodeAnim*> tracks;
    for (unsigned c = 0; c < scene.mAnimations[0]->mNumChannels; ++c) {
      const aiNodeAnim* track = scene.mAnimations[0]->mChannels[c];
      tracks[track->mNodeName.C_Str()] = track;
    }
    std::map<std::string, Eigen::Matrix4d> world;
    const std::function<void(const aiNode&, const Eigen::Matrix4d&)> visit = [&](const aiNode& node,
                                                                                 const Eigen::Matrix4d& parent) {
      Eigen::Matrix4d local = matrix(node.mTransformation);
      if (const auto found = tracks.find(node.mName.C_Str()); found != tracks.end()) {
        const aiNodeAnim& track = *found->second;
        const auto at = [&](unsigned count) { return count == 1 ? 0 : key; };  // a constant has one key
        local = matrix(aiMatrix4x4(aiVector3D(1, 1, 1), track.mRotationKeys[at(track.mNumRotationKeys)].mValue,
                                   track.mPositionKeys[at(track.mNumPositionKeys)].mValue));
      }
      world[node.mName.C_Str()] = parent * local;
      for (unsigned c = 0; c < node.mNumChildren; ++c) visit(*node.mChildren[c], world[node.mName.C_Str()]);
    };
    visit(*scene.mRootNode, Eigen::Matrix4d::Identity());
    return world;
  }

  const std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) / "motion.glb";
  Assimp::Importer importer_;
};

// The world's axes in every joint at rest, and a rig that has its own.
class GlbOfRig : public Glb, public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Axes, GlbOfRig, testing::Bool(),
                         [](const auto& param) { return param.param ? "OfItsOwn" : "OfTheWorld"; });

TEST_P(GlbOfRig, AnotherReaderPosesTheMeshAsWeDo) {
  const BodyModel body = GetParam() ? make_rotations_first_body() : make_test_body();
  const PoseTable poses = random_poses(body.skeleton, 12);
  ASSERT_TRUE(write_glb(path_, body, poses).ok());
  const aiScene* scene = read();
  ASSERT_EQ(scene->mNumMeshes, 1u);
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumVertices, body.rest.vertices.size());
  ASSERT_EQ(mesh.mNumFaces, body.rest.faces.size());
  const double tick_s = 1 / scene->mAnimations[0]->mTicksPerSecond;
  for (unsigned key = 0; key < poses.rows.size(); ++key) {
    const std::vector<double>& pose = poses.rows[key].values;
    const auto world = nodes_at(*scene, key);
    const auto expected_joints = body.skeleton.forward_kinematics(pose);
    for (int j = 0; j < body.skeleton.num_joints(); ++j) {
      const Rigid3& expected = expected_joints[static_cast<size_t>(j)];
      const Eigen::Matrix4d& found = world.at(body.skeleton.joints()[static_cast<size_t>(j)].name);
      EXPECT_LT((found.topRightCorner<3, 1>() - expected.translation).norm(), 1e-5);
      EXPECT_LT((found.topLeftCorner<3, 3>() - expected.rotation).norm(), 1e-5);
    }
    std::vector<Eigen::Vector4d> skinned(mesh.mNumVertices, Eigen::Vector4d::Zero());
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      const Eigen::Matrix4d world_from_mesh = world.at(bone.mName.C_Str()) * matrix(bone.mOffsetMatrix);
      for (unsigned w = 0; w < bone.mNumWeights; ++w) {
        const aiVector3D& x = mesh.mVertices[bone.mWeights[w].mVertexId];
        skinned[bone.mWeights[w].mVertexId] +=
            bone.mWeights[w].mWeight * (world_from_mesh * Eigen::Vector4d(x.x, x.y, x.z, 1));
      }
    }
    const std::vector<Eigen::Vector3f> expected = skin_vertices(body, pose);
    // By the corners of faces: Assimp 5.4 numbers the vertices in the order of their use.
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      ASSERT_EQ(mesh.mFaces[f].mNumIndices, 3u);
      for (unsigned k = 0; k < 3; ++k) {
        const Eigen::Vector4d& found = skinned.at(mesh.mFaces[f].mIndices[k]);
        const Eigen::Vector3d wanted = expected[body.rest.faces[f][k]].cast<double>();
        EXPECT_LT((found.head<3>() - wanted).norm(), 1e-5) << "face " << f << " corner " << k << " key " << key;
      }
    }
    EXPECT_NEAR(scene->mAnimations[0]->mChannels[0]->mRotationKeys[key].mTime * tick_s, poses.rows[key].time_s, 1e-4);
  }
}

// The parts of a GLB file, and accessors as numbers.
struct Parts {
  nlohmann::json json;
  std::string bytes;

  explicit Parts(const std::string& file) {
    const auto word = [&](size_t at) {
      uint32_t value = 0;
      std::memcpy(&value, file.data() + at, sizeof value);
      return value;
    };
    EXPECT_EQ(file.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), file.size());
    const size_t json_size = word(12);
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(file.substr(16, 4), "JSON");
    json = nlohmann::json::parse(file.substr(20, json_size));
    EXPECT_EQ(word(20 + json_size) % 4, 0u);
    EXPECT_EQ(file.substr(24 + json_size, 4), std::string("BIN\0", 4));
    bytes = file.substr(28 + json_size);
    EXPECT_EQ(bytes.size(), json["buffers"][0]["byteLength"].get<size_t>());
  }

  template <class T>
  std::vector<T> values(size_t accessor) const {
    const auto& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<size_t>()];
    std::vector<T> numbers(view["byteLength"].get<size_t>() / sizeof(T));
    std::memcpy(numbers.data(), bytes.data() + view["byteOffset"].get<size_t>(), numbers.size() * sizeof(T));
    return numbers;
  }
};

TEST_F(Glb, KeepsTheRulesOfTheFormat) {
  const BodyModel body = make_test_body();
  ASSERT_TRUE(write_glb(path_, body, random_poses(body.skeleton, 40)).ok());
  const Parts parts(read_text_file(path_).value());
  size_t end = 0;
  for (const auto& view : parts.json["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0u);
    EXPECT_GE(view["byteOffset"].get<size_t>(), end);
    end = view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>();
  }
  EXPECT_LE(end, parts.bytes.size());

  const auto& attributes = parts.json["meshes"][0]["primitives"][0]["attributes"];
  const auto& position = parts.json["accessors"][attributes["POSITION"].get<size_t>()];
  Eigen::Vector3f least = body.rest.vertices[0], most = least;
  for (const Eigen::Vector3f& x : body.rest.vertices) least = least.cwiseMin(x), most = most.cwiseMax(x);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(position["min"][k].get<float>(), least[static_cast<int>(k)]);
    EXPECT_EQ(position["max"][k].get<float>(), most[static_cast<int>(k)]);
  }
  const std::vector<float> normals = parts.values<float>(attributes["NORMAL"]);
  ASSERT_EQ(normals.size(), 3 * body.rest.vertices.size());
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {  // of a tube about the Y axis: outward
    const Eigen::Map<const Eigen::Vector3f> normal(normals.data() + 3 * v);
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
    EXPECT_GT(normal.dot(body.rest.vertices[v] - Eigen::Vector3f(0, 0.75F, 0)), 0);
  }
  const auto& animation = parts.json["animations"][0];
  for (const auto& sampler : animation["samplers"]) {
    EXPECT_EQ(sampler["interpolation"], "LINEAR");
    const auto& input = parts.json["accessors"][sampler["input"].get<size_t>()];
    EXPECT_EQ(input["min"][0].get<float>(), 1.0F);
    EXPECT_EQ(input["max"][0].get<float>(), static_cast<float>(1 + 0.04 * 39));
  }
  size_t num_rotations = 0;
  for (const auto& channel : animation["channels"]) {
    if (channel["target"]["path"] != "rotation") continue;
    ++num_rotations;
    const auto values = parts.values<float>(animation["samplers"][channel["sampler"].get<size_t>()]["output"]);
    ASSERT_EQ(values.size(), 40u * 4);
    for (size_t key = 0; key < 40; ++key) {
      const auto q = [&](size_t k) { return Eigen::Map<const Eigen::Vector4f>(values.data() + 4 * k); };
      EXPECT_NEAR(q(key).norm(), 1, 1e-6);
      EXPECT_GE(q(key).dot(q(std::max<size_t>(key, 1) - 1)), 0) << "a quaternion changes its sign at key " << key;
    }
  }
  EXPECT_EQ(num_rotations, 3u);
}

TEST_F(Glb, AVertexOfFiveJointsKeepsItsFourLargestWeights) {
  std::vector<Joint> joints = {{"root", -1, {0, 0, 0}, {}}};
  for (int j = 1; j < 5; ++j) joints.push_back({"j" + std::to_string(j), j - 1, {0, 1, 0}, {}});
  joints[0].dof_indices = {0};
  BodyModel body{
      .name = "five",
      .skeleton = Skeleton("five", joints, {{.name = "root_ry", .axis = Vector3d::UnitY(), .lower = -1, .upper = 1}})};
  body.rest = {.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .faces = {{0, 1, 2}}};
  body.skin = {.row_start = {0, 5, 6, 8},
               .joint_idx = {0, 1, 2, 3, 4, 2, 0, 4},
               .weight = {0.2F, 0.1F, 0.25F, 0.15F, 0.3F, 1, 0.4F, 0.6F}};
  body.joint_from_rest.assign(5, Rigid3{});
  ASSERT_TRUE(write_glb(path_, body, {}).ok());
  const Parts parts(read_text_file(path_).value());
  const auto& attributes = parts.json["meshes"][0]["primitives"][0]["attributes"];
  EXPECT_EQ(parts.values<uint16_t>(attributes["JOINTS_0"]),
            (std::vector<uint16_t>{4, 2, 0, 3, 2, 0, 0, 0, 4, 0, 0, 0}));
  const std::vector<float> weights = parts.values<float>(attributes["WEIGHTS_0"]);
  EXPECT_THAT(weights, testing::Pointwise(testing::FloatNear(1e-6F), {1 / 3.0F, 5 / 18.0F, 2 / 9.0F, 1 / 6.0F, 1.0F,
                                                                      0.0F, 0.0F, 0.0F, 0.6F, 0.4F, 0.0F, 0.0F}));
  EXPECT_FALSE(parts.json.contains("animations"));  // without poses
  EXPECT_EQ(read()->mNumAnimations, 0u);
}

TEST_F(Glb, ARowThatIsNotLaterHasNoKey) {
  const BodyModel body = make_test_body();
  PoseTable poses = random_poses(body.skeleton, 3);
  poses.rows[1].time_s = poses.rows[0].time_s;
  ASSERT_TRUE(write_glb(path_, body, poses).ok());
  const aiScene* scene = read();
  const aiNodeAnim& track = *scene->mAnimations[0]->mChannels[0];
  ASSERT_EQ(track.mNumRotationKeys, 2u);
  EXPECT_NEAR(track.mRotationKeys[1].mTime / scene->mAnimations[0]->mTicksPerSecond, poses.rows[2].time_s, 1e-4);
}

TEST_F(Glb, RefusesPosesOfAnotherBodyAndSaysWhereItCannotWrite) {
  const BodyModel body = make_test_body();
  PoseTable poses = random_poses(body.skeleton, 2);
  EXPECT_THAT(write_glb("no/such/place.glb", body, poses).error().message,
              testing::HasSubstr("no/such/place.glb: cannot be written"));
  poses.rows[1].values.pop_back();
  EXPECT_THROW((void)write_glb(path_, body, poses), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
