#include "silpose/experiment/descriptions.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "silpose/base/option_error.h"
#include "silpose/experiment/recorded_clip.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

Result<fs::path> find_description(const std::string& name, const fs::path& folder) {
  if (fs::path(name).extension() == ".toml") return fs::path(name);
  std::vector<std::string> known;
  for (const fs::path& file : all_descriptions(folder)) {
    known.push_back(file.stem().string());
    if (known.back() == name) return file;
  }
  return error("{}: no such experiment ({}, all, or a .toml file)", name, fmt::join(known, ", "));
}

Result<std::vector<fs::path>> find_descriptions(const GridChoice& choice) {
  std::vector<fs::path> files;
  for (const std::string& name : choice.names) {
    if (name == "all") {
      const std::vector<fs::path> all = all_descriptions(choice.folder);
      files.insert(files.end(), all.begin(), all.end());
      continue;
    }
    Result<fs::path> file = find_description(name, choice.folder);
    if (!file) return file.failure();
    files.push_back(std::move(*file));
  }
  return files;
}

Result<void> check_data_files(const Grid& grid, const fs::path& data) {
  for (const GridCell& cell : grid.cells) {
    if (cell.settings.is_recorded()) {
      if (data.empty()) {
        return error("{}: needs recorded clips ({} and others): give their folder with --data", grid.name,
                     cell.settings.clip[0]);
      }
      if (Result<void> found = check_clip_files(cell.settings, data); !found) return found;
      continue;
    }
    const std::string& motion = cell.settings.motion;
    if (!is_motion_file(motion)) continue;
    if (data.empty()) {
      return error("{}: needs motion-capture files ({} and others): give their folder with --data", grid.name, motion);
    }
    std::error_code failed;
    if (!fs::is_regular_file(data / motion, failed)) return error("{}: no such file", (data / motion).string());
  }
  return {};
}

}  // namespace

std::vector<fs::path> all_descriptions(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

Result<std::vector<Grid>> read_grids(const GridChoice& choice) {
  const Result<std::vector<fs::path>> files = find_descriptions(choice);
  if (!files) return files.failure();
  std::vector<Grid> grids;
  for (const fs::path& file : *files) {
    Result<Grid> grid = read_grid(file, choice.quick);
    if (!grid) return grid.failure();
    if (choice.seeds) grid->seeds = *choice.seeds;
    if (std::ranges::count(grids, grid->name, &Grid::name) > 0) throw_option_error("{}: given twice", grid->name);
    if (Result<void> found = check_data_files(*grid, choice.data); !found) return found.failure();
    grids.push_back(std::move(*grid));
  }
  return grids;
}

}  // namespace silpose
