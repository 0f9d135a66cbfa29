// The .body file: docs/formats.md describes it. A checked file (base/checked_file.h).
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "silpose/base/checked_file.h"
#include "silpose/body/body_model.h"
#include "silpose/body/default_profile.h"
#include "silpose/body/human_profile.h"

namespace silpose {
namespace {

static_assert(std::endian::native == std::endian::little, "the .body file is copied byte by byte");

// Version 2 added the levels, version 3 rest rotations and the rig's profile: an older file ends before them.
constexpr FileKind kBodyFile{.magic = "SILPBODY", .version = 3, .name = "body file", .oldest_version = 1};

enum DofFlag : uint8_t { kTranslation = 1, kPeriodic = 2, kShape = 4, kBounded = 8 };

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
  void put(const Eigen::Matrix3d& rotation) {
    for (int k = 0; k < 3; ++k) put(Eigen::Vector3d(rotation.col(k)));
  }
  void put(const std::optional<Eigen::Vector3d>& x) {
    put(static_cast<uint8_t>(x.has_value()));
    if (x) put(*x);
  }
  void put_indices(const std::vector<int>& indices) {
    put_count(indices.size());
    for (const int index : indices) put(static_cast<int32_t>(index));
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
  Eigen::Matrix3d get_rotation() {
    Eigen::Matrix3d rotation;
    for (int k = 0; k < 3; ++k) rotation.col(k) = get_vector();
    if ((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-6) {
      throw Malformed("a rotation is none");
    }
    return rotation;
  }
  std::optional<Eigen::Vector3d> get_optional_vector() {
    return get<uint8_t>() != 0 ? std::optional(get_vector()) : std::nullopt;
  }
  std::vector<int> get_indices() {
    const std::vector<int32_t> indices = get_array<int32_t>(get_count(sizeof(int32_t)));
    return {indices.begin(), indices.end()};
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
    out.put(static_cast<uint8_t>((dof.is_translation ? kTranslation : 0) | (dof.is_periodic ? kPeriodic : 0) |
                                 (dof.is_shape ? kShape : 0) | (dof.is_bounded ? kBounded : 0)));
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
    dof.is_translation = (flags & kTranslation) != 0;
    dof.is_periodic = (flags & kPeriodic) != 0;
    dof.is_shape = (flags & kShape) != 0;
    dof.is_bounded = (flags & kBounded) != 0;
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

void put_profile(Writer& out, const RigProfile& profile) {
  out.put_indices(profile.root_translations);
  out.put(static_cast<int32_t>(profile.heading.value_or(-1)));
  out.put(profile.up);
  out.put(profile.facing);
  out.put_count(profile.limbs.size());
  for (const Limb& limb : profile.limbs) {
    out.put_indices(limb.joints);
    out.put_indices(limb.dofs);
  }
  out.put_count(profile.limb_pairs.size());
  for (const auto& [right, left] : profile.limb_pairs) {
    out.put_count(right);
    out.put_count(left);
  }
  out.put_count(profile.across.size());
  for (const auto& [right, left] : profile.across) {
    out.put(static_cast<int32_t>(right));
    out.put(static_cast<int32_t>(left));
  }
  out.put_indices(profile.contact_joints);
  out.put_count(profile.landmarks.size());
  for (const RigProfile::Landmark& landmark : profile.landmarks) {
    out.put(landmark.name);
    out.put_count(landmark.other_names.size());
    for (const auto& [format, name] : landmark.other_names) {
      out.put(format);
      out.put(name);
    }
  }
  out.put_count(profile.origin.size());
  for (const std::string& name : profile.origin) out.put(name);
  for (const auto* of : {&profile.noise, &profile.acceleration, &profile.rest, &profile.rest_if_seen}) {
    out.put_array(of->data(), of->size());
  }
  out.put_count(profile.poses.size());
  for (const auto& [name, pose] : profile.poses) {
    out.put(name);
    out.put_array(pose.data(), pose.size());
  }
  out.put(profile.silhouette_area);
}

RigProfile get_profile(Reader& in, const Skeleton& skeleton) {
  RigProfile profile;
  const auto D = static_cast<size_t>(skeleton.num_dofs());
  profile.root_translations = in.get_indices();
  if (const auto heading = in.get<int32_t>(); heading >= 0) profile.heading = heading;
  profile.up = in.get_optional_vector();
  profile.facing = in.get_optional_vector();
  profile.limbs.resize(in.get_count(8));
  for (Limb& limb : profile.limbs) limb = {in.get_indices(), in.get_indices()};
  profile.limb_pairs.resize(in.get_count(8));
  for (auto& [right, left] : profile.limb_pairs) {
    right = in.get<uint32_t>();
    left = in.get<uint32_t>();
  }
  profile.across.resize(in.get_count(8));
  for (auto& [right, left] : profile.across) {
    right = in.get<int32_t>();
    left = in.get<int32_t>();
  }
  profile.contact_joints = in.get_indices();
  profile.landmarks.resize(in.get_count(8));
  for (RigProfile::Landmark& landmark : profile.landmarks) {
    landmark.name = in.get_text();
    for (size_t left = in.get_count(8); left > 0; --left) {
      std::string format = in.get_text();
      landmark.other_names[std::move(format)] = in.get_text();
    }
  }
  profile.origin.resize(in.get_count(4));
  for (std::string& name : profile.origin) name = in.get_text();
  for (auto* of : {&profile.noise, &profile.acceleration, &profile.rest, &profile.rest_if_seen}) {
    *of = in.get_array<double>(D);
  }
  profile.poses.resize(in.get_count(4));
  for (auto& [name, pose] : profile.poses) {
    name = in.get_text();
    pose = in.get_array<double>(D);
  }
  profile.silhouette_area = in.get<double>();
  check_profile(profile, skeleton);
  return profile;
}

// What version 3 added. Bodies of older files get the profile of the human, or the default one.
void get_rig(Reader& in, BodyModel& body) {
  if (in.at_end()) {
    body.profile = has_human_joints(body.skeleton) ? human_profile(body.skeleton) : default_profile(body);
    return;
  }
  std::vector<Joint> joints(body.skeleton.joints().begin(), body.skeleton.joints().end());
  for (Joint& joint : joints) joint.parent_from_rest = in.get_rotation();
  body.skeleton =
      Skeleton(body.skeleton.name(), std::move(joints), {body.skeleton.dofs().begin(), body.skeleton.dofs().end()});
  body.profile = get_profile(in, body.skeleton);
}

BodyModel get_body(Reader& in) {
  std::string name = in.get_text();
  Skeleton skeleton = get_skeleton(in);
  std::vector<Rigid3> joint_from_rest(static_cast<size_t>(skeleton.num_joints()));
  for (Rigid3& transform : joint_from_rest) {
    transform.rotation = in.get_rotation();
    transform.translation = in.get_vector();
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
                 .levels = {},
                 .profile = {}};
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
  get_rig(in, body);
  if (!in.at_end()) throw Malformed("bytes are left over");
  return body;
}

}  // namespace

Result<void> write_body(const std::filesystem::path& path, const BodyModel& body) {
  check_profile(body.profile, body.skeleton);
  Writer out;
  out.put(body.name);
  put_skeleton(out, body.skeleton);
  for (const Rigid3& transform : body.joint_from_rest) {
    out.put(transform.rotation);
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
  for (const Joint& joint : body.skeleton.joints()) out.put(joint.parent_from_rest);
  put_profile(out, body.profile);
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
