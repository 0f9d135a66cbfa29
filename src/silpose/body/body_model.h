// BodyModel: a skinned triangle mesh on a Skeleton, posed by linear blend skinning.
// x_in_world = sum_j w_j * world_from_joint_j(pose) * joint_from_rest_j * x_in_rest. The mesh keeps its own rest pose
// (MakeHuman's A-pose); joint_from_rest carries it to the skeleton's anatomical zero.
// Source: linear blend skinning (references.bib: magnenat1988).
// Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/rig_profile.h"
#include "silpose/body/skeleton.h"
#include "silpose/geometry/mesh.h"

namespace silpose {

// Skin weights by vertex in compressed rows: those of vertex v are entries [row_start[v], row_start[v + 1]).
struct SkinWeights {
  std::vector<uint32_t> row_start;  // [V + 1]
  std::vector<uint16_t> joint_idx;  // ascending within a vertex
  std::vector<float> weight;        // positive, sums to 1 for each vertex
};

// A coarser mesh of the same body: some of its vertices, joined by other faces.
struct BodyLevel {
  int asked_vertices = 0;              // what simplification was asked for
  std::vector<uint32_t> vertices;      // [v] indices of the whole mesh's, ascending
  std::vector<Face> faces;             // of these v
  double mean_iou = 0, worst_iou = 0;  // of its silhouettes with the whole body's (render/level_accuracy.h); 0: unknown
};

struct BodyModel {
  std::string name;  // "human:age=25,sex=f,height=1.620,weight=58.0"
  Skeleton skeleton;
  Mesh rest;  // rest pose, metres, floor at y = 0
  SkinWeights skin;
  std::vector<Rigid3> joint_from_rest;  // [J]
  struct EndPoint {
    std::string name;
    int joint_idx;
    Eigen::Vector3d offset_in_joint;
  };
  std::vector<EndPoint> end_points;          // fixed to a joint; human: head_top, {right,left}_toe_tip, _finger_tip
  double height_m = 0, weight_kg = 0;        // stature and mass of the rest mesh
  std::map<std::string, std::string> facts;  // how it was built: sliders, source data, its hash
  std::vector<BodyLevel> levels;             // from coarse to fine; those that level_of_detail() need not make
  RigProfile profile;                        // of `skeleton`: human_profile(), default_profile(), or the author's own
};

// Vertices [V] of the mesh for a pose [D], world coordinates. `world_from_joint` [J] is scratch and result.
void skin_vertices(const BodyModel& body, std::span<const double> pose, std::span<Rigid3> world_from_joint,
                   std::span<Eigen::Vector3f> vertices);
[[nodiscard]] std::vector<Eigen::Vector3f> skin_vertices(const BodyModel& body, std::span<const double> pose);

// [V] index of the joint that has most of each vertex's weight; the first of equals.
[[nodiscard]] std::vector<int> main_joints(const BodyModel& body);

// Joint centres in joint order, then end points: names and positions [J + E] in world coordinates.
[[nodiscard]] std::vector<std::string> landmark_names(const BodyModel& body);
[[nodiscard]] std::vector<Eigen::Vector3d> landmark_positions(const BodyModel& body, std::span<const double> pose);

// The largest distance between corresponding joints or end points, metres. Shapes: landmarks [J + E] of two poses.
[[nodiscard]] double furthest_apart(std::span<const Eigen::Vector3d> a, std::span<const Eigen::Vector3d> b);

// The zero pose with the lowest vertex on the floor y = 0 and the root above the origin, for rigs whose root
// translations go upwards; otherwise zeros. [D]
[[nodiscard]] std::vector<double> standing_pose(const BodyModel& body);

// A level of about `num_vertices` vertices: still closed, vertices kept where they were, outline kept (the human at
// 2,000 vertices: 0.6 mm off on average). Source: quadric error metric (garland1997), by meshoptimizer. Errors: throws
// std::invalid_argument when asked for fewer than 100.
[[nodiscard]] BodyLevel simplify(const BodyModel& body, int num_vertices);

// The level as a body of its own, without further levels. Stature and mass stay those of the whole mesh.
[[nodiscard]] BodyModel body_of_level(const BodyModel& body, const BodyLevel& level);

// The body at the level that was asked for with `num_vertices`: one of its own, or else made by simplify().
// Errors: as simplify().
[[nodiscard]] BodyModel level_of_detail(const BodyModel& body, int num_vertices);

// The coarsest of the body's own levels whose silhouettes share, on average, at least `mean_iou` with the whole body's.
[[nodiscard]] const BodyLevel* coarsest_level(const BodyModel& body, double mean_iou);  // null: there is none

// level_of_detail() of a shared body; with 0 vertices the body itself.
[[nodiscard]] std::shared_ptr<const BodyModel> level_of_detail(const std::shared_ptr<const BodyModel>& body,
                                                               int num_vertices);

// The .body file: everything above, compact and little-endian (docs/formats.md).
// Errors: missing, empty, truncated, wrong magic or version, checksum; each names the file. write_body() throws
// std::invalid_argument where the profile does not suit the skeleton.
Result<void> write_body(const std::filesystem::path& path, const BodyModel& body);
Result<BodyModel> load_body(const std::filesystem::path& path);

}  // namespace silpose
