// Which experiments: descriptions by name in a folder, or by path; and whether the data that they need is there.
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/experiment/grid.h"

namespace silpose {

// The descriptions of a folder, NAME.toml, by name.
std::vector<std::filesystem::path> all_descriptions(const std::filesystem::path& folder);

struct GridChoice {
  std::vector<std::string> names;  // of descriptions in `folder`; "all"; or paths to .toml files
  std::filesystem::path folder;    // experiments_directory() (base/data_folder.h)
  std::filesystem::path data;      // of motion-capture files and recorded clips; empty: none
  std::optional<int> seeds;        // in place of the grids' own
  bool quick = false;              // read_grid()
};

// In the order of the names. Errors: an unknown name; those of read_grid(); data that is not there, which is reported
// before hours of work, not after. Throws OptionError where a grid is named twice.
Result<std::vector<Grid>> read_grids(const GridChoice& choice);

}  // namespace silpose
