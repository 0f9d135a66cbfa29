#include "silpose/synth/degraded_mask.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/render/shaded.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

using Eigen::Vector3f;

constexpr size_t kLevels = 2048;  // of amplitude that are distinguished
constexpr double kClose = 0.005;  // to the wanted intersection over union
constexpr uint64_t kHoles = 5;
constexpr double kLeastShare = 0.01;  // of the mesh's faces: a joint with fewer is no segment

// One random stream per camera.
uint64_t stream_of(int camera_idx, uint64_t of_fault) { return 16 * static_cast<uint64_t>(camera_idx + 1) + of_fault; }

Mask draw_faces(const PinholeCamera& camera, std::span<const Vector3f> vertices, std::span<const Face> faces) {
  ProjectedMesh mesh;
  project_mesh(camera, vertices, faces, mesh);
  Mask mask;
  draw_silhouette_reference(mesh.pixels, faces, Window{.width = camera.width, .height = camera.height}, mask,
                            mesh.cut_faces);
  return mask;
}

// The height of the upright body in the image, at its distance in that pose. Pixels.
double height_in_image(const SyntheticSequence& sequence, const PinholeCamera& camera, std::span<const double> pose) {
  Vector3f lower = Vector3f::Constant(1e9F), upper = Vector3f::Constant(-1e9F);
  for (const Vector3f& vertex : sequence.body->rest.vertices) {
    lower = lower.cwiseMin(vertex);
    upper = upper.cwiseMax(vertex);
  }
  double depth = 0;
  const std::vector<Eigen::Vector3d> landmarks = landmark_positions(*sequence.body, pose);
  for (const Eigen::Vector3d& landmark : landmarks) depth += (camera.cam_from_world * landmark).z();
  depth = std::max(depth / static_cast<double>(landmarks.size()), PinholeCamera::kNear);
  return std::max(camera.fy * (upper - lower).maxCoeff() / depth, 1.0);
}

// By face the joint that moves most of it.
std::vector<int> joint_of_faces(const BodyModel& body) {
  const std::vector<int> joint_of_vertex = main_joints(body);
  std::vector<int> joints;
  for (const Face& face : body.rest.faces) {
    const int a = joint_of_vertex[face[0]], b = joint_of_vertex[face[1]], c = joint_of_vertex[face[2]];
    joints.push_back(b == c ? b : a);
  }
  return joints;
}

// Joints that turn and carry part of the mesh, in chains that end without branching: arms and legs, a snake's bones;
// not a joint that is a chain by itself, such as a head.
std::vector<int> limb_segments(const BodyModel& body, std::span<const int> joint_of_face) {
  const std::span<const Joint> joints = body.skeleton.joints();
  std::vector<std::vector<int>> children(joints.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent_idx >= 0) children[static_cast<size_t>(joints[j].parent_idx)].push_back(static_cast<int>(j));
  }
  std::vector<int> segments;
  for (size_t j = 0; j < joints.size(); ++j) {
    bool is_chain = joints[j].parent_idx >= 0 && !joints[j].dof_indices.empty();
    for (size_t at = j; is_chain && !children[at].empty(); at = static_cast<size_t>(children[at][0])) {
      is_chain = children[at].size() == 1;
    }
    const bool is_alone =
        children[j].empty() && is_chain && children[static_cast<size_t>(joints[j].parent_idx)].size() > 1;
    const auto share = std::count(joint_of_face.begin(), joint_of_face.end(), static_cast<int>(j));
    if (is_chain && !is_alone &&
        static_cast<double>(share) >= kLeastShare * static_cast<double>(joint_of_face.size())) {
      segments.push_back(static_cast<int>(j));
    }
  }
  return segments;
}

// A time in which something is wrong, and numbers drawn for it.
struct Spell {
  double start_s = 0, end_s = 0;
  std::array<double, 4> drawn{};  // uniform in [0, 1)
};

// Spells one after the other over the sequence; lengths in seconds.
std::vector<Spell> draw_spells(const SyntheticSequence& sequence, Rng rng, std::array<double, 2> gap,
                               std::array<double, 2> length) {
  std::vector<Spell> spells;
  double time = rng.uniform(0, gap[1]) + sequence.lead_in / sequence.fps;
  while (time < sequence.num_frames() / sequence.fps) {
    Spell spell{.start_s = time, .end_s = time + rng.uniform(length[0], length[1]), .drawn = {}};
    for (double& value : spell.drawn) value = rng.uniform();
    time = spell.end_s + rng.uniform(gap[0], gap[1]);
    spells.push_back(spell);
  }
  return spells;
}

std::function<Mask(int)> shadow_fault(const SyntheticSequence& sequence, int camera_idx) {
  return [&sequence, camera_idx](int frame) {
    Mask mask = true_mask(sequence, camera_idx, frame);
    const Vector3f to_light = Lighting{}.to_light.cast<float>();
    std::vector<Vector3f> vertices = skin_vertices(*sequence.body, pose_of_frame(sequence, frame));
    for (Vector3f& vertex : vertices) vertex -= vertex.y() / to_light.y() * to_light;
    const Mask shadow =
        draw_faces(sequence.cameras[static_cast<size_t>(camera_idx)], vertices, sequence.body->rest.faces);
    for (int y = 0; y < mask.height(); ++y) {
      for (size_t i = 0; i < mask.row(y).size(); ++i) mask.row(y)[i] |= shadow.row(y)[i];
    }
    return mask;
  };
}

Result<std::function<Mask(int)>> limb_fault(const SyntheticSequence& sequence, int camera_idx, uint64_t seed) {
  const std::vector<int> joint_of_face = joint_of_faces(*sequence.body);
  const std::vector<int> segments = limb_segments(*sequence.body, joint_of_face);
  if (segments.empty()) return error("{}: has no limbs to be missing", sequence.body->name);
  const std::vector<Spell> spells = draw_spells(sequence, Rng(seed, stream_of(camera_idx, 1)), {0.2, 0.8}, {0.3, 1});
  std::function<Mask(int)> draw = [&sequence, camera_idx, joint_of_face, segments, spells](int frame) {
    const double time = frame / sequence.fps;
    for (const Spell& spell : spells) {
      if (time < spell.start_s || time >= spell.end_s) continue;
      const int missing = segments[static_cast<size_t>(spell.drawn[0] * static_cast<double>(segments.size()))];
      std::vector<Face> faces;
      for (size_t f = 0; f < joint_of_face.size(); ++f) {
        if (joint_of_face[f] != missing) faces.push_back(sequence.body->rest.faces[f]);
      }
      return draw_faces(sequence.cameras[static_cast<size_t>(camera_idx)],
                        skin_vertices(*sequence.body, pose_of_frame(sequence, frame)), faces);
    }
    return true_mask(sequence, camera_idx, frame);
  };
  return draw;
}

// An ellipse of a hole is cut; what lies at the outline is left, so that the hole stays one.
void cut_hole(const Mask& truth, const Eigen::Vector2d& centre, double radius, double aspect, double angle,
              Mask& mask) {
  const auto is_inside = [&](int x, int y) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!truth.get(x + dx, y + dy)) return false;
      }
    }
    return true;
  };
  const int reach = static_cast<int>(std::ceil(radius)), x0 = static_cast<int>(centre.x()),
            y0 = static_cast<int>(centre.y());
  for (int y = std::max(1, y0 - reach); y <= std::min(truth.height() - 2, y0 + reach); ++y) {
    for (int x = std::max(1, x0 - reach); x <= std::min(truth.width() - 2, x0 + reach); ++x) {
      const double dx = x + 0.5 - centre.x(), dy = y + 0.5 - centre.y();
      const double along = std::cos(angle) * dx + std::sin(angle) * dy,
                   across = std::cos(angle) * dy - std::sin(angle) * dx;
      if (std::hypot(along, across / aspect) <= radius && is_inside(x, y)) mask.set(x, y, false);
    }
  }
}

std::function<Mask(int)> hole_fault(const SyntheticSequence& sequence, int camera_idx, uint64_t seed) {
  std::vector<Spell> spells;
  for (uint64_t hole = 0; hole < kHoles; ++hole) {
    const auto of_hole = draw_spells(sequence, Rng(seed, stream_of(camera_idx, 2), hole), {0, 0.5}, {0.3, 1.2});
    spells.insert(spells.end(), of_hole.begin(), of_hole.end());
  }
  std::vector<double> area = {0};  // of the rest mesh up to each face: a hole may be anywhere on the skin
  for (const Face& face : sequence.body->rest.faces) {
    const std::vector<Vector3f>& x = sequence.body->rest.vertices;
    area.push_back(area.back() + (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]).norm());
  }
  return [&sequence, camera_idx, spells, area](int frame) {
    const PinholeCamera& camera = sequence.cameras[static_cast<size_t>(camera_idx)];
    const std::span<const double> pose = pose_of_frame(sequence, frame);
    const std::vector<Vector3f> vertices = skin_vertices(*sequence.body, pose);
    const double height = height_in_image(sequence, camera, pose), time = frame / sequence.fps;
    const Mask truth = true_mask(sequence, camera_idx, frame);
    Mask mask = truth;
    for (const Spell& spell : spells) {
      if (time < spell.start_s || time >= spell.end_s) continue;
      const auto& [place, size, shape, turn] = spell.drawn;
      const auto face = std::upper_bound(area.begin() + 1, area.end() - 1, place * area.back()) - area.begin() - 1;
      const uint32_t vertex = sequence.body->rest.faces[static_cast<size_t>(face)][0];
      const auto centre = camera.project(vertices[vertex].cast<double>());
      if (!centre || !(centre->cwiseAbs().maxCoeff() < 1e6)) continue;
      // It opens and closes again.
      const double open = std::sqrt(std::sin(kPi * (time - spell.start_s) / (spell.end_s - spell.start_s)));
      cut_hole(truth, *centre, open * (0.02 + 0.03 * size) * height, 0.5 + 0.5 * shape, kPi * turn, mask);
    }
    return mask;
  };
}

// At how many levels of amplitude the pixels of one frame change: those that vanish, those that are added.
struct Changes {
  int64_t area = 0;  // of the true mask
  std::vector<uint32_t> lost = std::vector<uint32_t>(kLevels), added = std::vector<uint32_t>(kLevels);
};

size_t level_of(double amplitude) {
  return std::min(static_cast<size_t>(amplitude / OutlineNoise::kLargestAmplitude * kLevels), kLevels - 1);
}

// Mean over frames of the intersection over union by number of levels that are reached [kLevels + 1].
std::vector<double> iou_by_level(const std::vector<Changes>& frames) {
  std::vector<double> sum(kLevels + 1, 0.0);
  double count = 0;
  for (const Changes& frame : frames) {
    if (frame.area == 0) continue;
    int64_t lost = 0, added = 0;
    count += 1;
    sum[0] += 1;
    for (size_t level = 0; level < kLevels; ++level) {
      lost += frame.lost[level], added += frame.added[level];
      sum[level + 1] += static_cast<double>(frame.area - lost) / static_cast<double>(frame.area + added);
    }
  }
  for (double& value : sum) value /= std::max(count, 1.0);
  return sum;
}

// The number of levels with which the wanted mean is met.
Result<size_t> find_levels(const SyntheticSequence& sequence, int camera_idx, const OutlineNoise& outline,
                           double wanted) {
  const PinholeCamera& camera = sequence.cameras[static_cast<size_t>(camera_idx)];
  std::vector<Changes> frames(static_cast<size_t>(sequence.num_frames()));
  parallel_for(frames.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = std::max(begin, static_cast<size_t>(sequence.lead_in)); i < end; ++i) {
      const int frame = static_cast<int>(i);
      const Mask truth = true_mask(sequence, camera_idx, frame);
      const double height = height_in_image(sequence, camera, pose_of_frame(sequence, frame));
      frames[i].area = truth.count();
      for (const OutlineNoise::Change& change : outline.changes(truth, height, frame / sequence.fps)) {
        ++(truth.get(change.x, change.y) ? frames[i].lost : frames[i].added)[level_of(change.amplitude)];
      }
    }
  });
  // Larger amplitudes only change more pixels, so the mean falls: bisection.
  const std::vector<double> iou = iou_by_level(frames);
  auto found = std::partition_point(iou.begin(), iou.end(), [&](double value) { return value > wanted; });
  if (found == iou.end()) --found;
  if (found != iou.begin() && std::abs(*(found - 1) - wanted) < std::abs(*found - wanted)) --found;
  if (std::abs(*found - wanted) > kClose) {
    return error("outline noise: no amplitude gives an intersection over union of {:.3f}; the nearest is {:.3f}",
                 wanted, *found);
  }
  return static_cast<size_t>(found - iou.begin());
}

std::function<Mask(int)> edge_fault(const SyntheticSequence& sequence, int camera_idx, const OutlineNoise& outline,
                                    size_t levels) {
  return [&sequence, camera_idx, outline, levels](int frame) {
    const Mask truth = true_mask(sequence, camera_idx, frame);
    const double height =
        height_in_image(sequence, sequence.cameras[static_cast<size_t>(camera_idx)], pose_of_frame(sequence, frame));
    Mask mask = truth;
    for (const OutlineNoise::Change& change : outline.changes(truth, height, frame / sequence.fps)) {
      if (level_of(change.amplitude) < levels) mask.set(change.x, change.y, !truth.get(change.x, change.y));
    }
    return mask;
  };
}

}  // namespace

Result<MaskFault> parse_mask_fault(const std::string& text) {
  if (text == "none") return MaskFault::kNone;
  if (text == "shadow") return MaskFault::kShadow;
  if (text == "edge") return MaskFault::kEdge;
  if (text == "limb") return MaskFault::kLimb;
  if (text == "hole") return MaskFault::kHole;
  return error("noise '{}': none, shadow, edge, limb or hole", text);
}

Result<DegradedMasks> DegradedMasks::create(const SyntheticSequence& sequence, int camera_idx, const MaskNoise& noise) {
  check(camera_idx >= 0 && static_cast<size_t>(camera_idx) < sequence.cameras.size(), "DegradedMasks: camera {} of {}",
        camera_idx, sequence.cameras.size());
  check(noise.iou > 0 && noise.iou < 1, "DegradedMasks: intersection over union {}", noise.iou);
  DegradedMasks masks(sequence, camera_idx);
  switch (noise.fault) {
    case MaskFault::kNone:
      masks.fault_ = [&sequence, camera_idx](int frame) { return true_mask(sequence, camera_idx, frame); };
      break;
    case MaskFault::kShadow:
      masks.fault_ = shadow_fault(sequence, camera_idx);
      break;
    case MaskFault::kHole:
      masks.fault_ = hole_fault(sequence, camera_idx, noise.seed);
      break;
    case MaskFault::kLimb: {
      Result<std::function<Mask(int)>> draw = limb_fault(sequence, camera_idx, noise.seed);
      if (!draw) return draw.failure();
      masks.fault_ = std::move(*draw);
      break;
    }
    case MaskFault::kEdge: {
      const OutlineNoise outline(noise.outline, noise.seed, stream_of(camera_idx, 0));
      const Result<size_t> levels = find_levels(sequence, camera_idx, outline, noise.iou);
      if (!levels) return levels.failure();
      masks.fault_ = edge_fault(sequence, camera_idx, outline, *levels);
      break;
    }
  }
  if (noise.fault != MaskFault::kNone) masks.measure();
  return masks;
}

Mask DegradedMasks::draw(int frame) const {
  return pose_of_frame(*sequence_, frame).empty() ? true_mask(*sequence_, camera_idx_, frame) : fault_(frame);
}

void DegradedMasks::measure() {
  std::vector<std::optional<double>> iou(static_cast<size_t>(sequence_->num_frames()));
  parallel_for(iou.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = std::max(begin, static_cast<size_t>(sequence_->lead_in)); i < end; ++i) {
      const Mask truth = true_mask(*sequence_, camera_idx_, static_cast<int>(i));
      if (truth.count() > 0) iou[i] = intersection_over_union(truth, draw(static_cast<int>(i)));
    }
  });
  double sum = 0, count = 0;
  for (const std::optional<double>& value : iou) {
    if (value) sum += *value, count += 1;
  }
  mean_iou_ = count > 0 ? sum / count : 1;
}

Result<std::vector<Mask>> degraded_masks(const SyntheticSequence& sequence, int camera_idx, const MaskNoise& noise) {
  const Result<DegradedMasks> degraded = DegradedMasks::create(sequence, camera_idx, noise);
  if (!degraded) return degraded.failure();
  std::vector<Mask> masks(static_cast<size_t>(sequence.num_frames()));
  parallel_for(masks.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) masks[i] = degraded->draw(static_cast<int>(i));
  });
  return masks;
}

}  // namespace silpose
