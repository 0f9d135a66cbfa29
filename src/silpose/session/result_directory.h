// ResultDirectory: a directory of results is written as DIR.partial and renamed to DIR when it is whole; an earlier
// result under DIR is replaced only then. A directory that holds anything silpose does not write is never touched.
// Threads: one thread per directory.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "silpose/base/result.h"

namespace silpose {

class ResultDirectory {
 public:
  // Makes DIR.partial, empty. With `resume` what is there stays, even where the work fails, if it can be resumed from.
  // Errors: DIR is a file or holds something else; not writable.
  static Result<ResultDirectory> create(const std::filesystem::path& directory, bool resume = false);

  // Where to write.
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  // Where it will be.
  [[nodiscard]] const std::filesystem::path& final_path() const { return final_; }

  // Renames to DIR, without what only --resume needs.
  Result<void> commit();
  // Leaves DIR.partial as it is. Without either, the destructor removes it: the work failed.
  void keep() { partial_.clear(); }

  ResultDirectory(ResultDirectory&& other) noexcept { *this = std::move(other); }
  ResultDirectory& operator=(ResultDirectory&& other) noexcept {
    std::swap(final_, other.final_);
    std::swap(partial_, other.partial_);
    std::swap(stays_, other.stays_);
    return *this;
  }
  ~ResultDirectory();

 private:
  ResultDirectory() = default;
  std::filesystem::path final_, partial_;  // partial_ is empty once it is renamed or kept
  bool stays_ = false;                     // partial_ was there before
};

// Whether it holds a finished result of silpose.
bool is_whole_result(const std::filesystem::path& directory);

// What the directory holds that silpose does not write; nothing when it may be replaced. An absent or empty directory
// may.
std::optional<std::string> foreign_content(const std::filesystem::path& directory, bool must_be_whole);

}  // namespace silpose
