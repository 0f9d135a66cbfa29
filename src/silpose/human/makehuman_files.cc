#include "silpose/human/makehuman_files.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

namespace silpose {
namespace {

// Walks over the words of a text, line by line.
class Words {
 public:
  explicit Words(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  bool next_line() {
    if (started_) {
      while (at_ < end_ && *at_ != '\n') ++at_;
      if (at_ < end_) ++at_;
    }
    started_ = true;
    return at_ < end_;
  }
  std::string_view word() {
    skip_blanks();
    const char* begin = at_;
    while (at_ < end_ && *at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\n') ++at_;
    return {begin, static_cast<size_t>(at_ - begin)};
  }
  template <class Number>
  bool number(Number& out) {
    skip_blanks();
    const auto [after, status] = std::from_chars(at_, end_, out);
    at_ = after;
    return status == std::errc();
  }
  bool at_line_end() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n';
  }
  bool skip_slash_number() {
    uint32_t ignored = 0;
    return at_ < end_ && *at_ == '/' && (++at_, number(ignored));
  }

 private:
  void skip_blanks() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r')) ++at_;
  }
  const char* at_;
  const char* end_;
  bool started_ = false;
};

using Quad = std::array<uint32_t, 4>;

void split_quad(const std::vector<Eigen::Vector3f>& x, const Quad& q, std::vector<Face>& faces) {
  if ((x[q[0]] - x[q[2]]).squaredNorm() <= (x[q[1]] - x[q[3]]).squaredNorm()) {
    faces.push_back({q[0], q[1], q[2]});
    faces.push_back({q[0], q[2], q[3]});
  } else {
    faces.push_back({q[0], q[1], q[3]});
    faces.push_back({q[1], q[2], q[3]});
  }
}

}  // namespace

Result<MakeHumanMesh> parse_makehuman_mesh(const std::string& name, std::string_view text) {
  MakeHumanMesh mesh;
  std::vector<Quad> body;
  std::map<std::string, std::vector<uint32_t>> cubes;
  std::string group;
  Words words(text);
  for (size_t line = 1; words.next_line(); ++line) {
    const std::string_view kind = words.word();
    if (kind == "v") {
      Eigen::Vector3f x;
      if (!words.number(x[0]) || !words.number(x[1]) || !words.number(x[2])) {
        return error("{}: line {} is not a vertex", name, line);
      }
      mesh.vertices.push_back(x);
    } else if (kind == "g") {
      group = words.word();
    } else if (kind == "f") {
      Quad quad{};
      for (uint32_t& v : quad) {
        if (!words.number(v) || v == 0 || v > mesh.vertices.size()) {
          return error("{}: line {} is not a quad of known vertices", name, line);
        }
        words.skip_slash_number();
        --v;
      }
      if (group == "body") {
        body.push_back(quad);
      } else if (group.starts_with("joint-")) {
        cubes[group].insert(cubes[group].end(), quad.begin(), quad.end());
      }
    }
  }
  if (mesh.vertices.size() != kNumMakeHumanVertices) {
    return error("{}: {} vertices, not {}", name, mesh.vertices.size(), kNumMakeHumanVertices);
  }
  for (const Quad& quad : body) {
    if (*std::max_element(quad.begin(), quad.end()) >= kNumBodyVertices) {
      return error("{}: the body uses helper vertices", name);
    }
    split_quad(mesh.vertices, quad, mesh.body_faces);
  }
  for (auto& [cube, corners] : cubes) {
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    if (corners.size() != 8) return error("{}: group {} is not a cube", name, cube);
    std::copy(corners.begin(), corners.end(), mesh.cubes[cube].begin());
  }
  return mesh;
}

Result<MakeHumanTarget> parse_makehuman_target(const std::string& name, std::string_view text) {
  MakeHumanTarget target;
  Words words(text);
  for (size_t line = 1; words.next_line(); ++line) {
    if (words.at_line_end()) continue;
    uint32_t v = 0;
    Eigen::Vector3f offset;
    if (!words.number(v) || v >= kNumMakeHumanVertices || !words.number(offset[0]) || !words.number(offset[1]) ||
        !words.number(offset[2])) {
      return error("{}: line {} is not a vertex and its offset", name, line);
    }
    target.vertex_idx.push_back(v);
    target.offset.push_back(offset);
  }
  return target;
}

Result<SkinWeights> parse_makehuman_weights(const std::string& name, const std::string& rig_text,
                                            const std::string& weights_text,
                                            const std::map<std::string, int>& joint_from_bone) {
  const nlohmann::json rig = nlohmann::json::parse(rig_text, nullptr, false);
  const nlohmann::json weights = nlohmann::json::parse(weights_text, nullptr, false);
  if (!rig.is_object() || !weights.is_object() || !weights.contains("weights") || !weights["weights"].is_object()) {
    return error("{}: not the expected JSON", name);
  }
  const nlohmann::json& bones = rig.contains("bones") ? rig["bones"] : rig;
  const auto find_joint = [&](std::string bone) -> int {
    for (size_t step = 0; step <= bones.size(); ++step) {
      if (const auto found = joint_from_bone.find(bone); found != joint_from_bone.end()) return found->second;
      if (!bones.contains(bone) || !bones[bone].is_object()) return -1;
      bone = bones[bone].value("parent", "");
    }
    return -1;
  };

  std::vector<std::map<uint16_t, double>> merged(kNumBodyVertices);
  for (const auto& [bone, entries] : weights["weights"].items()) {
    if (entries.empty()) continue;
    const int joint = find_joint(bone);
    if (joint < 0) return error("{}: bone {} hangs below no joint", name, bone);
    for (const nlohmann::json& entry : entries) {
      if (!entry.is_array() || entry.size() != 2 || !entry[0].is_number_unsigned() || !entry[1].is_number()) {
        return error("{}: a weight of bone {} is malformed", name, bone);
      }
      const uint64_t v = entry[0].get<uint64_t>();
      const double weight = entry[1].get<double>();
      if (v < kNumBodyVertices && weight > 0) merged[v][static_cast<uint16_t>(joint)] += weight;
    }
  }
  SkinWeights skin{.row_start = {0}, .joint_idx = {}, .weight = {}};
  for (uint32_t v = 0; v < kNumBodyVertices; ++v) {
    double sum = 0;
    for (const auto& [joint, weight] : merged[v]) sum += weight;
    if (!(sum > 0)) return error("{}: vertex {} has no weight", name, v);
    for (const auto& [joint, weight] : merged[v]) {
      skin.joint_idx.push_back(joint);
      skin.weight.push_back(static_cast<float>(weight / sum));
    }
    skin.row_start.push_back(static_cast<uint32_t>(skin.weight.size()));
  }
  return skin;
}

Result<std::string> gunzip(const std::string& name, std::string_view bytes, size_t max_bytes) {
  z_stream stream{};
  constexpr int kGzip = 16 + MAX_WBITS;
  if (bytes.size() > max_bytes || inflateInit2(&stream, kGzip) != Z_OK) return error("{}: cannot unpack", name);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string text;
  std::array<char, 1 << 16> chunk;  // [definition]
  int status = Z_OK;
  while (status == Z_OK && text.size() < max_bytes) {
    const size_t room = std::min(chunk.size(), max_bytes - text.size());
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(room);
    status = inflate(&stream, Z_NO_FLUSH);
    text.append(chunk.data(), room - stream.avail_out);
  }
  inflateEnd(&stream);
  if (status != Z_STREAM_END) return error("{}: damaged gzip file", name);
  return text;
}

}  // namespace silpose
