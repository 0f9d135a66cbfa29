// The MakeHuman file formats that silpose reads: base mesh (OBJ), shape targets, skin weights. Units and axes stay as
// in the files: decimetres, Y up, facing +Z, the character's left at +X.
// Based on: the hm08 base mesh and its assets, CC0 (references.bib: makehuman).
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/mesh.h"

namespace silpose {

// The body is vertices 0 to kNumBodyVertices - 1; the rest are helpers, among them cubes that mark joints.
inline constexpr uint32_t kNumBodyVertices = 13380;
inline constexpr uint32_t kNumMakeHumanVertices = 19158;

struct MakeHumanMesh {
  std::vector<Eigen::Vector3f> vertices;                 // [19158]
  std::vector<Face> body_faces;                          // quads split along their shorter diagonal
  std::map<std::string, std::array<uint32_t, 8>> cubes;  // group "joint-NAME" -> its vertices
};

// How far each moved vertex is moved.
struct MakeHumanTarget {
  std::vector<uint32_t> vertex_idx;
  std::vector<Eigen::Vector3f> offset;
};

// Errors: malformed; each names `name`.
Result<MakeHumanMesh> parse_makehuman_mesh(const std::string& name, std::string_view text);
Result<MakeHumanTarget> parse_makehuman_target(const std::string& name, std::string_view text);

// Weights of the rig's bones, each bone's added to the joint of its nearest ancestor (or itself) in `joint_from_bone`,
// for the body vertices, normalised. `rig_text` and `weights_text` are the two JSON files.
Result<SkinWeights> parse_makehuman_weights(const std::string& name, const std::string& rig_text,
                                            const std::string& weights_text,
                                            const std::map<std::string, int>& joint_from_bone);

// Errors: not gzip, damaged, more than `max_bytes` unpacked; names `name`.
Result<std::string> gunzip(const std::string& name, std::string_view bytes, size_t max_bytes);

}  // namespace silpose
