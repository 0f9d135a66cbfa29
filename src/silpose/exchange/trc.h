// TRC: marker positions over time, as OpenSim and Pose2Sim read them; here the markers are joint centres.
// Based on: the Motion Analysis TRC format as OpenSim reads it (references.bib: delp2007).
// Threads: values and functions without state.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

struct MarkerTable {
  struct Row {
    int64_t frame = 0;
    double time_s = 0;
    std::vector<Eigen::Vector3d> x_in_world;  // [M] metres; empty: nothing was seen in this frame
  };
  std::vector<std::string> names;  // [M]
  std::vector<Row> rows;
};

// World axes and metres, as everywhere; a row without positions is written with its frame, its time and blanks.
// Errors: not writable. Throws std::invalid_argument when there is no marker, a row has another number of positions,
// one is not finite, or fps is not positive.
Result<void> write_trc(const std::filesystem::path& path, const MarkerTable& table, double fps);

}  // namespace silpose
