// The .body file: docs/formats.md describes it. A checked file (base/checked_file.h).
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "silpose/base/checked_file.h"
#include "silpose/body/body_model.h"

namespace silpose {
namespace {

static_assert(std::endian::native == std::endian::little, "the .body file is copied byte by byte");

// Levels came with version 2; a body without any is written as version 1, which older programs read.
constexpr FileKind kPlainBodyFile{.magic = "SILPBODY", .version = 1, .name = "body file"};
constexpr FileKind kBodyFile{.magic = "SILPBODY", .version = 2, .name = "body file", .oldest_version = 1};

class Writer {
 public:
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void put_count(size_t count) { put(static_cast<uint32_t>(count)); }
  void put(const std::string& text) {
    put_count(text.size());
    bytes_ += text;
  }
  void put(const Eigen::Vector3d& x) {
    for (int k = 0; k < 3; ++k) put(x[k]);
  }
  template <class T>
  void put_array(const T* data, size_t count) {
    if (count > 0) bytes_.append(reinterpret_cast<const char*>(data), count * sizeof(T));
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

struct Malformed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads what Writer wrote; throws Malformed, before anything is allocated, when there is less than is asked for.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    T value;
    copy(&value, 1);
    return value;
  }
  // A count of things that take at least `min_bytes` each.
  size_t get_count(size_t min_bytes) {
    const size_t count = get<uint32_t>();
    if (count > bytes_.size() / min_bytes) throw Malformed("a count is larger than the file");
    return count;
  }
  std::string get_text() {
    const size_t size = get_count(1);
    std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }
  Eigen::Vector3d get_vector() {
    Eigen::Vector3d x;
    copy(x.data(), 3);
    if (!x.allFinite()) throw Malformed("a coordinate is not finite");
    return x;
  }
  template <class T>
  std::vector<T> get_array(size_t count) {
    if (count > bytes_.size() / sizeof(T)) throw Malformed("it ends too early");
    std::vector<T> out(count);
    copy(out.data(), count);
    return out;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  template <class T>
  void copy(T* data, size_t count) {
    if (count > bytes_.size() / sizeof(T)) throw Malformed("it ends too early");
    if (count > 0) std::memcpy(static_cast<void*>(data), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
  }
  std::string_view bytes_;
};

void put_skeleton(Writer& out, const Skeleton& skeleton) {
  out.put(skeleton.name());
  out.put_count(skeleton.joints().size());
  for (const Joint& joint : skeleton.joints()) {
    out.put(joint.name);
    out.put(static_cast<int32_t>(joint.parent_idx));
    out.put(joint.offset_in_parent);
    out.put_count(joint.dof_indices.size());
    for (const int d : joint.dof_indices) out.put(static_cast<int32_t>(d));
  }
  out.put_count(skeleton.dofs().size());
  for (const Dof& dof : skeleton.dofs()) {
    out.put(dof.name);
    out.put(static_cast<int32_t>(dof.joint_idx));
    out.put(static_cast<uint8_t>((dof.is_translation ? 1 : 0) | (dof.is_periodic ? 2 : 0)));
    out.put(dof.axis);
    out.put(dof.lower);
    out.put(dof.upper);
  }
}

Skeleton get_skeleton(Reader& in) {
  const std::string name = in.get_text();
  std::vector<Joint> joints(in.get_count(36));
  for (Joint& joint : joints) {
    joint.name = in.get_text();
    joint.parent_idx = in.get<int32_t>();
    joint.offset_in_parent = in.get_vector();
    joint.dof_indices.resize(in.get_count(4));
    for (int& d : joint.dof_indices) d = in.get<int32_t>();
  }
  std::vector<Dof> dofs(in.get_count(49));
  for (Dof& dof : dofs) {
    dof.name = in.get_text();
    dof.joint_idx = in.get<int32_t>();
    const uint8_t flags = in.get<uint8_t>();
    dof.is_translation = (flags & 1) != 0;
    dof.is_periodic = (flags & 2) != 0;
    dof.axis = in.get_vector();
    dof.lower = in.get<double>();
    dof.upper = in.get<double>();
  }
  return Skeleton(name, std::move(joints), std::move(dofs));
}

void check_mesh(const Mesh& mesh, const SkinWeights& skin, size_t num_joints) {
  for (const Eigen::Vector3f& x : mesh.vertices) {
    if (!x.allFinite()) throw Malformed("a coordinate is not finite");
  }
  for (const Face& face : mesh.faces) {
    for (const uint32_t v : face) {
      if (v >= mesh.vertices.size()) throw Malformed("a face uses a vertex that is not there");
    }
  }
  if (skin.row_start.front() != 0 || skin.row_start.back() != skin.weight.size()) {
    throw Malformed("the skin weights do not match the vertices");
  }
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (skin.row_start[v] >= skin.row_start[v + 1] || skin.row_start[v + 1] > skin.weight.size()) {
      throw Malformed("a vertex has no skin weights");
    }
    float sum = 0;
    for (uint32_t i = skin.row_start[v]; i < skin.row_start[v + 1]; ++i) {
      if (skin.joint_idx[i] >= num_joints || !(skin.weight[i] > 0)) throw Malformed("a skin weight is out of range");
      sum += skin.weight[i];
    }
    if (!(std::abs(sum - 1) < 1e-3f)) throw Malformed("the skin weights of a vertex do not sum to 1");
  }
}

std::vector<BodyLevel> get_levels(Reader& in, size_t num_vertices) {
  std::vector<BodyLevel> levels(in.get_count(28));
  for (BodyLevel& level : levels) {
    level.asked_vertices = in.get<int32_t>();
    level.mean_iou = in.get<double>();
    level.worst_iou = in.get<double>();
    for (const double iou : {level.mean_iou, level.worst_iou}) {
      if (!(iou >= 0 && iou <= 1)) throw Malformed("an overlap is not within 0 and 1");
    }
    level.vertices = in.get_array<uint32_t>(in.get_count(sizeof(uint32_t)));
    level.faces = in.get_array<Face>(in.get_count(sizeof(Face)));
    if (level.vertices.empty() || level.faces.empty()) throw Malformed("a level has no vertices or no faces");
    for (size_t v = 0; v < level.vertices.size(); ++v) {
      const bool ascends = v == 0 || level.vertices[v - 1] < level.vertices[v];
      if (!ascends || level.vertices[v] >= num_vertices) throw Malformed("a level's vertices are not the body's");
    }
    for (const Face& face : level.faces) {
      for (const uint32_t v : face) {
        if (v >= level.vertices.size()) throw Malformed("a level's face uses a vertex that is not there");
      }
    }
  }
  return levels;
}

BodyModel get_body(Reader& in) {
  std::string name = in.get_text();
  Skeleton skeleton = get_skeleton(in);
  std::vector<Rigid3> joint_from_rest(static_cast<size_t>(skeleton.num_joints()));
  for (Rigid3& transform : joint_from_rest) {
    for (int k = 0; k < 3; ++k) transform.rotation.col(k) = in.get_vector();
    transform.translation = in.get_vector();
    if ((transform.rotation * transform.rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-6) {
      throw Malformed("a rotation is none");
    }
  }
  BodyModel body{.name = std::move(name),
                 .skeleton = std::move(skeleton),
                 .rest = {},
                 .skin = {},
                 .joint_from_rest = std::move(joint_from_rest),
                 .end_points = {},
                 .height_m = 0,
                 .weight_kg = 0,
                 .facts = {},
                 .levels = {}};
  body.rest.vertices = in.get_array<Eigen::Vector3f>(in.get_count(sizeof(Eigen::Vector3f)));
  body.rest.faces = in.get_array<Face>(in.get_count(sizeof(Face)));
  body.skin.row_start = in.get_array<uint32_t>(body.rest.vertices.size() + 1);
  const size_t num_weights = in.get_count(sizeof(uint16_t) + sizeof(float));
  body.skin.joint_idx = in.get_array<uint16_t>(num_weights);
  body.skin.weight = in.get_array<float>(num_weights);
  check_mesh(body.rest, body.skin, body.joint_from_rest.size());
  body.end_points.resize(in.get_count(32));
  for (BodyModel::EndPoint& end_point : body.end_points) {
    end_point.name = in.get_text();
    end_point.joint_idx = in.get<int32_t>();
    end_point.offset_in_joint = in.get_vector();
    if (end_point.joint_idx < 0 || end_point.joint_idx >= body.skeleton.num_joints()) {
      throw Malformed("an end point is at a joint that is not there");
    }
  }
  body.height_m = in.get<double>();
  body.weight_kg = in.get<double>();
  for (size_t left = in.get_count(8); left > 0; --left) {
    std::string key = in.get_text();
    body.facts[std::move(key)] = in.get_text();
  }
  if (!in.at_end()) body.levels = get_levels(in, body.rest.vertices.size());
  if (!in.at_end()) throw Malformed("bytes are left over");
  return body;
}

}  // namespace

Result<void> write_body(const std::filesystem::path& path, const BodyModel& body) {
  Writer out;
  out.put(body.name);
  put_skeleton(out, body.skeleton);
  for (const Rigid3& transform : body.joint_from_rest) {
    for (int k = 0; k < 3; ++k) out.put(Eigen::Vector3d(transform.rotation.col(k)));
    out.put(transform.translation);
  }
  out.put_count(body.rest.vertices.size());
  out.put_array(body.rest.vertices.data(), body.rest.vertices.size());
  out.put_count(body.rest.faces.size());
  out.put_array(body.rest.faces.data(), body.rest.faces.size());
  out.put_array(body.skin.row_start.data(), body.skin.row_start.size());
  out.put_count(body.skin.weight.size());
  out.put_array(body.skin.joint_idx.data(), body.skin.joint_idx.size());
  out.put_array(body.skin.weight.data(), body.skin.weight.size());
  out.put_count(body.end_points.size());
  for (const BodyModel::EndPoint& end_point : body.end_points) {
    out.put(end_point.name);
    out.put(static_cast<int32_t>(end_point.joint_idx));
    out.put(end_point.offset_in_joint);
  }
  out.put(body.height_m);
  out.put(body.weight_kg);
  out.put_count(body.facts.size());
  for (const auto& [key, value] : body.facts) {
    out.put(key);
    out.put(value);
  }
  if (body.levels.empty()) return write_checked_file(path, kPlainBodyFile, out.bytes());
  out.put_count(body.levels.size());
  for (const BodyLevel& level : body.levels) {
    out.put(static_cast<int32_t>(level.asked_vertices));
    out.put(level.mean_iou);
    out.put(level.worst_iou);
    out.put_count(level.vertices.size());
    out.put_array(level.vertices.data(), level.vertices.size());
    out.put_count(level.faces.size());
    out.put_array(level.faces.data(), level.faces.size());
  }
  return write_checked_file(path, kBodyFile, out.bytes());
}

Result<BodyModel> load_body(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_checked_file(path, kBodyFile);
  if (!bytes) return bytes.failure();
  try {
    Reader in(*bytes);
    return get_body(in);
  } catch (const Malformed& malformed) {
    return error("{}: malformed body file: {}", path.string(), malformed.what());
  } catch (const std::invalid_argument& refused) {  // by Skeleton
    return error("{}: malformed body file: {}", path.string(), refused.what());
  }
}

}  // namespace silpose
