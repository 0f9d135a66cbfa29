#include "silpose/exchange/glb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/exchange/bvh.h"

namespace silpose {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "values are copied into the file byte by byte");

enum ComponentType { kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };
enum BufferTarget { kNoTarget = 0, kVertexData = 34962, kIndexData = 34963 };

class Writer {
 public:
  Writer(const BodyModel& body, const PoseTable& poses) : body_(body), poses_(poses) {}

  std::string write() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "silpose"}};
    json_["scene"] = 0;
    add_nodes();
    add_mesh();
    add_skin();
    if (!poses_.rows.empty()) add_animation();
    json_["bufferViews"] = std::move(views_);
    json_["accessors"] = std::move(accessors_);
    json_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    return file(json_.dump(-1, ' ', false, Json::error_handler_t::replace));  // names come from files
  }

 private:
  // Appends `values`, all of one accessor whose elements have `width` numbers; returns the accessor.
  template <class T>
  size_t add(const std::vector<T>& values, size_t width, const char* type, ComponentType component,
             BufferTarget target = kNoTarget, bool with_range = false) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target != kNoTarget) view["target"] = static_cast<int>(target);
    Json accessor = {{"bufferView", views_.size()},
                     {"componentType", static_cast<int>(component)},
                     {"count", values.size() / width},
                     {"type", type}};
    if (with_range) {
      std::vector<T> least(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width)), most = least;
      for (size_t i = 0; i < values.size(); ++i) {
        least[i % width] = std::min(least[i % width], values[i]);
        most[i % width] = std::max(most[i % width], values[i]);
      }
      accessor["min"] = least;
      accessor["max"] = most;
    }
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    bytes_.append((4 - bytes_.size() % 4) % 4, '\0');
    views_.push_back(std::move(view));
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  // Node 0 is the mesh, node 1 + j joint j.
  void add_nodes() {
    const std::vector<double> pose = standing_pose(body_);
    const Clip rest = clip_from_poses(body_.skeleton, std::span(&pose, 1), 1);
    Json nodes = Json::array({{{"name", body_.name}, {"mesh", 0}, {"skin", 0}}});
    Json roots = Json::array({0});
    for (size_t j = 0; j < rest.num_joints(); ++j) {
      const Eigen::Quaterniond& q = rest.rotations[j];
      const Eigen::Vector3d& t = rest.translations[j];
      nodes.push_back({{"name", rest.joints[j].name},
                       {"translation", {t.x(), t.y(), t.z()}},
                       {"rotation", {q.x(), q.y(), q.z(), q.w()}}});
      const int parent = rest.joints[j].parent_idx;
      if (parent < 0) {
        roots.push_back(1 + j);
      } else {
        nodes[1 + static_cast<size_t>(parent)]["children"].push_back(1 + j);
      }
    }
    json_["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
    json_["nodes"] = std::move(nodes);
  }

  void add_mesh() {
    const Mesh& mesh = body_.rest;
    std::vector<Eigen::Vector3f> turned(mesh.vertices.size(), Eigen::Vector3f::Zero());
    std::vector<uint32_t> indices;
    for (const Face& face : mesh.faces) {
      const Eigen::Vector3f& a = mesh.vertices[face[0]];
      const Eigen::Vector3f normal = (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);  // by area
      for (const uint32_t v : face) turned[v] += normal;
      indices.insert(indices.end(), face.begin(), face.end());
    }
    std::vector<float> positions, normals;
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      Eigen::Vector3f normal = turned[v].normalized();
      if (!(normal.squaredNorm() > 0.5F)) normal = Eigen::Vector3f::UnitY();  // of no face
      positions.insert(positions.end(), mesh.vertices[v].begin(), mesh.vertices[v].end());
      normals.insert(normals.end(), normal.begin(), normal.end());
    }
    Json attributes;
    attributes["POSITION"] = add(positions, 3, "VEC3", kFloat, kVertexData, true);
    attributes["NORMAL"] = add(normals, 3, "VEC3", kFloat, kVertexData);
    const auto [joints, weights] = four_weights();
    attributes["JOINTS_0"] = add(joints, 4, "VEC4", kUint16, kVertexData);
    attributes["WEIGHTS_0"] = add(weights, 4, "VEC4", kFloat, kVertexData);
    const size_t faces = add(indices, 1, "SCALAR", kUint32, kIndexData);
    const Json matt = {{"baseColorFactor", {0.8, 0.65, 0.55, 1.0}}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}};
    json_["materials"] = Json::array({{{"name", "body"}, {"pbrMetallicRoughness", matt}}});
    const Json primitive = {{"attributes", std::move(attributes)}, {"indices", faces}, {"material", 0}};
    json_["meshes"] = Json::array({{{"name", body_.name}, {"primitives", Json::array({primitive})}}});
  }

  // [V * 4] joints and weights. The largest weight takes what rounding leaves of 1; unused entries are joint 0.
  std::pair<std::vector<uint16_t>, std::vector<float>> four_weights() const {
    const SkinWeights& skin = body_.skin;
    std::vector<uint16_t> joints(4 * body_.rest.vertices.size());
    std::vector<float> weights(joints.size());
    std::vector<uint32_t> order;
    for (size_t v = 0; v < body_.rest.vertices.size(); ++v) {
      order.clear();
      for (uint32_t i = skin.row_start[v]; i < skin.row_start[v + 1]; ++i) order.push_back(i);
      std::stable_sort(order.begin(), order.end(),
                       [&](uint32_t a, uint32_t b) { return skin.weight[a] > skin.weight[b]; });
      order.resize(std::min<size_t>(order.size(), 4));
      float sum = 0, others = 0;
      for (const uint32_t i : order) sum += skin.weight[i];
      for (size_t k = 0; k < order.size(); ++k) {
        joints[4 * v + k] = skin.joint_idx[order[k]];
        weights[4 * v + k] = skin.weight[order[k]] / sum;
        if (k > 0) others += weights[4 * v + k];
      }
      weights[4 * v] = 1 - others;
    }
    return {std::move(joints), std::move(weights)};
  }

  void add_skin() {
    std::vector<float> matrices;  // joint from mesh, column by column
    Json joints = Json::array();
    for (size_t j = 0; j < body_.joint_from_rest.size(); ++j) {
      const Rigid3& joint_from_rest = body_.joint_from_rest[j];
      Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
      matrix.topLeftCorner<3, 3>() = joint_from_rest.rotation.cast<float>();
      matrix.topRightCorner<3, 1>() = joint_from_rest.translation.cast<float>();
      matrices.insert(matrices.end(), matrix.data(), matrix.data() + matrix.size());
      joints.push_back(1 + j);
    }
    const size_t inverse_bind = add(matrices, 16, "MAT4", kFloat);
    json_["skins"] = Json::array({{{"inverseBindMatrices", inverse_bind}, {"joints", std::move(joints)}}});
  }

  void add_animation() {
    std::vector<std::vector<double>> poses;
    std::vector<float> times;
    for (const PoseTable::Row& row : poses_.rows) {
      const auto time_s = static_cast<float>(row.time_s);
      if (!times.empty() && time_s <= times.back()) continue;
      times.push_back(time_s);
      poses.push_back(row.values);
    }
    const Clip clip = clip_from_poses(body_.skeleton, poses, 1);
    const size_t input = add(times, 1, "SCALAR", kFloat, kNoTarget, true);
    Json channels = Json::array(), samplers = Json::array();
    const auto add_channel = [&](size_t joint, const char* what, size_t output) {
      channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", 1 + joint}, {"path", what}}}});
      samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    };
    for (size_t j = 0; j < clip.num_joints(); ++j) {
      bool turns = false, moves = false;
      for (const int d : body_.skeleton.joints()[j].dof_indices) {
        (body_.skeleton.dofs()[static_cast<size_t>(d)].is_translation ? moves : turns) = true;
      }
      std::vector<float> rotations, translations;
      Eigen::Quaterniond previous = Eigen::Quaterniond::Identity();
      for (size_t frame = 0; frame < clip.num_frames(); ++frame) {
        const size_t at = frame * clip.num_joints() + j;
        Eigen::Quaterniond q = clip.rotations[at];
        if (q.dot(previous) < 0) q.coeffs() *= -1;  // the shorter way from key to key
        previous = q;
        for (const double value : q.coeffs()) rotations.push_back(static_cast<float>(value));  // x, y, z, w
        for (const double value : clip.translations[at]) translations.push_back(static_cast<float>(value));
      }
      if (turns) add_channel(j, "rotation", add(rotations, 4, "VEC4", kFloat));
      if (moves) add_channel(j, "translation", add(translations, 3, "VEC3", kFloat));
    }
    if (channels.empty()) return;
    json_["animations"] =
        Json::array({{{"name", "motion"}, {"channels", std::move(channels)}, {"samplers", std::move(samplers)}}});
  }

  // Header, JSON chunk, binary chunk.
  std::string file(std::string json) const {
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string out = "glTF";
    const auto put = [&](size_t value) {
      const auto number = static_cast<uint32_t>(value);
      out.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    put(2);
    put(12 + 8 + json.size() + 8 + bytes_.size());
    put(json.size());
    out += "JSON" + json;
    put(bytes_.size());
    out.append("BIN\0", 4);
    return out + bytes_;
  }

  const BodyModel& body_;
  const PoseTable& poses_;
  Json json_, views_ = Json::array(), accessors_ = Json::array();
  std::string bytes_;
};

}  // namespace

Result<void> write_glb(const std::filesystem::path& path, const BodyModel& body, const PoseTable& poses) {
  check(!body.rest.vertices.empty() && !body.rest.faces.empty(), "write_glb: a body without a mesh");
  return write_text_file(path, Writer(body, poses).write());
}

}  // namespace silpose
