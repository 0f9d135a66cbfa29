#include "silpose/experiment/experiment_directory.h"

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

namespace silpose {
namespace {

namespace fs = std::filesystem;

bool is_experiment_file(const fs::directory_entry& entry) {
  if (entry.is_directory()) return entry.path().filename() == "runs";
  const fs::path ending = entry.path().extension();
  return entry.path().filename() == "results.json" || ending == ".csv" || ending == ".svg";
}

bool is_finished(const fs::path& folder) {
  std::ifstream file(folder / "results.json");
  const nlohmann::json results = nlohmann::json::parse(file, nullptr, false);
  return results.is_object() && results.contains("command") && results["command"].is_string() &&
         results["command"].get<std::string>().starts_with("silpose ");
}

// An entry that no experiment has written; nothing when there is none, or no such directory.
std::optional<std::string> foreign_entry(const fs::path& directory, bool must_be_finished) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, failed)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || (must_be_finished && !is_finished(entry.path()))) return name;
    for (const fs::directory_entry& file : fs::directory_iterator(entry.path(), failed)) {
      if (!is_experiment_file(file)) return name + "/" + file.path().filename().string();
    }
  }
  if (failed && failed != std::errc::no_such_file_or_directory) return failed.message();
  return std::nullopt;
}

}  // namespace

Result<ExperimentDirectory> ExperimentDirectory::create(const fs::path& directory, bool resume) {
  ExperimentDirectory made;
  made.final_ = directory.has_filename() ? directory : directory.parent_path();  // "out/" is "out"
  if (made.final_.filename() == "." || made.final_.filename() == ".." || made.final_.filename().empty()) {
    return error("{}: give the output directory by its name", directory.string());
  }
  made.partial_ = made.final_;
  made.partial_ += ".partial";
  std::error_code failed;
  for (const fs::path& path : {made.final_, made.partial_}) {
    if (fs::exists(path, failed) && !fs::is_directory(path, failed)) {
      return error("{}: exists and is not a directory", path.string());
    }
    const auto foreign = foreign_entry(path, path == made.final_);
    if (foreign)
      return error("{}: holds something other than experiments ({}); left unchanged", path.string(), *foreign);
  }
  if (!resume) fs::remove_all(made.partial_, failed);
  fs::create_directories(made.partial_, failed);
  if (failed || access(made.partial_.c_str(), W_OK) != 0) {
    return error("{}: not writable ({})", directory.string(), failed ? failed.message() : "permission denied");
  }
  return made;
}

Result<void> ExperimentDirectory::commit(const std::vector<std::string>& names) {
  std::error_code failed;
  fs::create_directories(final_, failed);
  if (failed) return error("{}: not writable ({})", final_.string(), failed.message());
  for (const std::string& name : names) {
    const fs::path earlier = partial_ / (name + ".old");
    fs::remove_all(partial_ / name / "runs", failed);
    if (fs::exists(final_ / name)) fs::rename(final_ / name, earlier, failed);
    if (failed) return error("{}: cannot be replaced ({})", (final_ / name).string(), failed.message());
    fs::rename(partial_ / name, final_ / name, failed);
    if (failed) {
      std::error_code ignored;
      fs::rename(earlier, final_ / name, ignored);
      return error("{}: cannot be renamed ({})", (partial_ / name).string(), failed.message());
    }
  }
  fs::remove_all(partial_, failed);
  return {};
}

}  // namespace silpose
