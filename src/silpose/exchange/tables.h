// Tables: the plain values that result and truth files hold, and their CSV form (docs/formats.md).
// Threads: values and functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/skeleton.h"

namespace silpose {

// poses.csv, poses_normalised.csv and spread.csv: one row per frame, one value per column.
struct PoseTable {
  struct Row {
    int64_t frame = 0;
    double time_s = 0;
    std::vector<double> values;                             // [D] natural units (m, rad), or NPSU
    double visual_accuracy = 0, effective_sample_size = 0;  // written in a result only
  };
  std::vector<Row> rows;
  bool has_scores = false;  // the two columns above are there
};

enum class PoseUnits { kNatural, kNormalised };  // natural: metres and degrees in the file, radians in memory

Result<void> write_poses(const std::filesystem::path& path, const Skeleton& skeleton, const PoseTable& table,
                         PoseUnits units = PoseUnits::kNatural);
// Errors: missing, empty, wrong or missing columns, not a number, NaN, frames out of order; names file and line.
Result<PoseTable> read_poses(const std::filesystem::path& path, const Skeleton& skeleton,
                             PoseUnits units = PoseUnits::kNatural);

// joints.csv, long form.
struct JointTable {
  struct Row {
    int64_t frame = 0;
    double time_s = 0;
    std::string joint;
    Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();  // metres
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();       // first camera, the library's pixels; NaN: unseen
    Eigen::Vector3d sd = Eigen::Vector3d::Zero();          // metres, written in a result only
  };
  std::vector<Row> rows;
  bool has_spread = false;
};
Result<void> write_joints(const std::filesystem::path& path, const JointTable& table);
// A truth may lack u_px, v_px or joints; missing pixels are NaN.
Result<JointTable> read_joints(const std::filesystem::path& path);

}  // namespace silpose
