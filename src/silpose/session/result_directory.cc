#include "silpose/session/result_directory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "silpose/session/mask_files.h"
#include "silpose/session/result_files.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

bool is_mask_folder(const fs::path& folder) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const std::string stem = entry.path().stem().string();
    const bool digits =
        !stem.empty() && std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || entry.path().extension() != ".png" || !entry.is_regular_file()) return false;
  }
  return !failed;
}

// What a track resumes from.
bool is_for_resuming(const std::string& name) { return name == kCheckpointFile || name.starts_with(kConfidenceFolder); }

bool is_own(const fs::directory_entry& entry) {
  std::string name = entry.path().filename().string();
  if (entry.is_directory()) {
    const bool is_known =
        name == kMaskFolder || name.starts_with(std::string(kMaskFolder) + "_") || is_for_resuming(name);
    return is_known && is_mask_folder(entry.path());
  }
  if (name.ends_with(".tmp")) name.resize(name.size() - 4);  // of a program that was killed (base/text_file.h)
  if (name.starts_with("video_") && name.ends_with(".mp4")) return true;
  return std::ranges::find(kResultFiles, name, &ResultFile::name) != std::end(kResultFiles);
}

}  // namespace

bool is_whole_result(const fs::path& directory) {
  std::ifstream file(directory / "run.json");
  const nlohmann::json run = nlohmann::json::parse(file, nullptr, false);
  return run.is_object() && run.contains("command") && run["command"].is_string() &&
         run["command"].get<std::string>().starts_with("silpose ");
}

std::optional<std::string> foreign_content(const fs::path& directory, bool must_be_whole) {
  std::error_code failed;
  bool empty = true;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, failed)) {
    empty = false;
    if (!is_own(entry)) return entry.path().filename().string();
  }
  if (failed && failed != std::errc::no_such_file_or_directory) return failed.message();
  if (!empty && must_be_whole && !is_whole_result(directory)) return "files, but no run.json of silpose";
  return std::nullopt;
}

Result<ResultDirectory> ResultDirectory::create(const fs::path& directory, bool resume) {
  ResultDirectory result;
  result.final_ = directory.has_filename() ? directory : directory.parent_path();  // "out/" is "out"
  if (result.final_.filename() == "." || result.final_.filename() == ".." || result.final_.filename().empty()) {
    return error("{}: give the output directory by its name", directory.string());
  }
  fs::path partial = result.final_;
  partial += ".partial";

  std::error_code failed;
  for (const fs::path& path : {result.final_, partial}) {
    const fs::file_status status = fs::status(path, failed);
    if (!fs::exists(status)) continue;
    if (!fs::is_directory(status)) return error("{}: exists and is not a directory", path.string());
    const std::optional<std::string> foreign = foreign_content(path, path == result.final_);
    if (foreign)
      return error("{}: holds something other than a result of silpose ({}); left unchanged", path.string(), *foreign);
  }
  result.stays_ = resume && fs::exists(partial / kCheckpointFile, failed);
  if (!result.stays_) fs::remove_all(partial, failed);
  fs::create_directories(partial, failed);
  if (failed || access(partial.c_str(), W_OK) != 0) {
    return error("{}: not writable ({})", directory.string(), failed ? failed.message() : "permission denied");
  }
  result.partial_ = partial;
  return Result<ResultDirectory>(std::move(result));
}

Result<void> ResultDirectory::commit() {
  std::error_code failed;
  std::vector<fs::path> passing;
  for (const fs::directory_entry& entry : fs::directory_iterator(partial_, failed)) {
    if (is_for_resuming(entry.path().filename().string())) passing.push_back(entry.path());
  }
  for (const fs::path& path : passing) fs::remove_all(path, failed);
  fs::path earlier;
  if (fs::exists(final_)) {
    earlier = final_;
    earlier += fmt::format(".old-{}", getpid());
    fs::rename(final_, earlier, failed);
    if (failed) return error("{}: cannot be replaced ({})", final_.string(), failed.message());
  }
  fs::rename(partial_, final_, failed);
  if (failed) {
    std::error_code ignored;
    if (!earlier.empty()) fs::rename(earlier, final_, ignored);
    return error("{}: cannot be renamed ({})", partial_.string(), failed.message());
  }
  partial_.clear();
  if (!earlier.empty()) fs::remove_all(earlier, failed);
  return {};
}

ResultDirectory::~ResultDirectory() {
  std::error_code ignored;
  if (!partial_.empty() && !stays_) fs::remove_all(partial_, ignored);
}

}  // namespace silpose
