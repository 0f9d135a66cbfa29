// read_glb FILE.glb: the nodes of a glTF file at every key of its animation, as Assimp reads it: time_s, name, x_m,
// y_m, z_m, tabs between.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cstdio>

namespace {

const aiNodeAnim* track_of(const aiAnimation& animation, const aiString& node) {
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    if (animation.mChannels[c]->mNodeName == node) return animation.mChannels[c];
  }
  return nullptr;
}

void print(const aiAnimation& animation, const aiNode& node, const aiMatrix4x4& world_from_parent, double time_s,
           unsigned key) {
  aiMatrix4x4 local = node.mTransformation;
  if (const aiNodeAnim* track = track_of(animation, node.mName)) {
    const unsigned turn = track->mNumRotationKeys == 1 ? 0 : key, place = track->mNumPositionKeys == 1 ? 0 : key;
    local = aiMatrix4x4(aiVector3D(1, 1, 1), track->mRotationKeys[turn].mValue, track->mPositionKeys[place].mValue);
  }
  const aiMatrix4x4 world = world_from_parent * local;
  std::printf("%.6f\t%s\t%.6f\t%.6f\t%.6f\n", time_s, node.mName.C_Str(), static_cast<double>(world.a4),
              static_cast<double>(world.b4), static_cast<double>(world.c4));
  for (unsigned c = 0; c < node.mNumChildren; ++c) print(animation, *node.mChildren[c], world, time_s, key);
}

}  // namespace

int main(int argc, char** argv) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(argc == 2 ? argv[1] : "", aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mNumAnimations != 1 || scene->mNumMeshes != 1 || !scene->mMeshes[0]->HasBones()) {
    std::fprintf(stderr, "read_glb: not one mesh with a skin and an animation: %s\n", importer.GetErrorString());
    return 1;
  }
  const aiAnimation& animation = *scene->mAnimations[0];
  const aiNodeAnim* longest = animation.mChannels[0];
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    if (animation.mChannels[c]->mNumRotationKeys > longest->mNumRotationKeys) longest = animation.mChannels[c];
  }
  for (unsigned key = 0; key < longest->mNumRotationKeys; ++key) {
    print(animation, *scene->mRootNode, aiMatrix4x4(), longest->mRotationKeys[key].mTime / animation.mTicksPerSecond,
          key);
  }
}
