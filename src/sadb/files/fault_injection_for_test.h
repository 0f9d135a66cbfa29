// FaultyFileSystem: a FileSystem of one folder in memory, for tests of code that uses one. It fails on request, and a
// crash takes away what was not synced.
// Threads: as FileSystem; the faults are set while nothing else runs.
// Based on: the fault injection test of LevelDB (references.bib: leveldb).
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sadb/files/file_system.h"
#include "silpose/base/check.h"

namespace sadb {

enum class Fault {
  kNoEffect,    // the operation does nothing
  kShortWrite,  // an append leaves the first half of its bytes; any other operation does nothing
};

class FaultyFileSystem final : public FileSystem {
 public:
  explicit FaultyFileSystem(std::filesystem::path folder)
      : folder_(std::move(folder)), state_(std::make_shared<State>()) {}

  // The operation after the next `num_good` ones fails, once. Each call of a FileSystem or WritableFile is one.
  void fail_after(int64_t num_good, Fault fault = Fault::kNoEffect) {
    const std::lock_guard lock(state_->mutex);
    state_->fails_at = state_->num_operations + num_good;
    state_->fault = fault;
  }

  // All so far, with those that failed.
  [[nodiscard]] int64_t num_operations() const {
    const std::lock_guard lock(state_->mutex);
    return state_->num_operations;
  }

  // Leaves what a crash may leave: names as last synced; of each file the synced bytes and the first `num_kept` of
  // those after them. Files that were open fail from now on; a fault that did not happen yet is called off.
  void crash(size_t num_kept = 0) {
    const std::lock_guard lock(state_->mutex);
    ++state_->num_crashes;
    state_->fails_at.reset();
    state_->names = state_->synced_names;
    for (const auto& [name, contents] : state_->names) {
      contents->bytes.resize(std::min(contents->bytes.size(), contents->num_synced + num_kept));
      contents->num_synced = contents->bytes.size();
    }
  }

  silpose::Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) override {
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(path); !good) return good.failure();
    const auto [at, is_new] = state_->names.try_emplace(path.filename().string(), std::make_shared<Contents>());
    if (!is_new) return silpose::error("{}: File exists", path.string());
    return std::unique_ptr<WritableFile>(std::make_unique<File>(path, state_, at->second));
  }

  silpose::Result<std::string> read(const std::filesystem::path& path, int64_t offset,
                                    int64_t max_bytes) const override {
    silpose::check(offset >= 0 && max_bytes >= 0, "read: {} bytes at {}", max_bytes, offset);
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(path); !good) return good.failure();
    const auto found = state_->names.find(path.filename().string());
    if (found == state_->names.end()) return no_such(path);
    const std::string& bytes = found->second->bytes;
    return bytes.substr(std::min(static_cast<size_t>(offset), bytes.size()), static_cast<size_t>(max_bytes));
  }

  silpose::Result<void> rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    silpose::check(from.parent_path() == to.parent_path(), "rename: {} to {}, another folder", from.string(),
                   to.string());
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(from); !good) return good;
    const auto found = state_->names.find(from.filename().string());
    if (found == state_->names.end()) return no_such(from);
    const std::shared_ptr<Contents> contents = found->second;
    state_->names.erase(found);
    state_->names[to.filename().string()] = contents;
    return {};
  }

  silpose::Result<void> remove(const std::filesystem::path& path) override {
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(path); !good) return good;
    if (state_->names.erase(path.filename().string()) == 0) return no_such(path);
    return {};
  }

  silpose::Result<std::vector<std::string>> list(const std::filesystem::path& folder) const override {
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(folder / "any"); !good) return good.failure();
    std::vector<std::string> names;
    for (const auto& [name, contents] : state_->names) names.push_back(name);
    return names;
  }

  silpose::Result<void> sync_folder(const std::filesystem::path& folder) override {
    const std::lock_guard lock(state_->mutex);
    if (auto good = begin(folder / "any"); !good) return good;
    state_->synced_names = state_->names;
    return {};
  }

 private:
  struct Contents {
    std::string bytes;
    size_t num_synced = 0;
  };
  using Names = std::map<std::string, std::shared_ptr<Contents>>;

  struct State {
    std::mutex mutex;
    Names names, synced_names;
    int64_t num_operations = 0, num_crashes = 0;
    std::optional<int64_t> fails_at;
    Fault fault = Fault::kNoEffect;

    // Counts an operation; whether it is the one that fails. REQUIRES: the lock.
    bool is_failing() { return num_operations++ == fails_at; }
  };

  class File final : public WritableFile {
   public:
    File(std::filesystem::path path, std::shared_ptr<State> state, std::shared_ptr<Contents> contents)
        : path_(std::move(path)),
          state_(std::move(state)),
          contents_(std::move(contents)),
          num_crashes_(state_->num_crashes) {}

    silpose::Result<void> append(std::string_view bytes) override {
      const std::lock_guard lock(state_->mutex);
      if (auto good = begin(); !good) {
        if (is_short_) contents_->bytes += bytes.substr(0, bytes.size() / 2);
        is_short_ = false;
        return good;
      }
      contents_->bytes += bytes;
      return {};
    }

    silpose::Result<void> sync() override {
      const std::lock_guard lock(state_->mutex);
      if (auto good = begin(); !good) return good;
      contents_->num_synced = contents_->bytes.size();
      return {};
    }

   private:
    // REQUIRES: the lock.
    silpose::Result<void> begin() {
      if (state_->num_crashes != num_crashes_) return silpose::error("{}: the machine crashed", path_.string());
      if (failed_) return silpose::error("{}: an earlier write failed", path_.string());
      failed_ = state_->is_failing();
      is_short_ = failed_ && state_->fault == Fault::kShortWrite;
      if (failed_) return silpose::error("{}: No space left on device", path_.string());
      return {};
    }

    const std::filesystem::path path_;
    const std::shared_ptr<State> state_;
    const std::shared_ptr<Contents> contents_;
    const int64_t num_crashes_;  // before the file was opened
    bool failed_ = false, is_short_ = false;
  };

  static tl::unexpected<silpose::Error> no_such(const std::filesystem::path& path) {
    return silpose::error("{}: No such file or directory", path.string());
  }

  // REQUIRES: the lock. Errors: the operation is to fail; a path in another folder.
  silpose::Result<void> begin(const std::filesystem::path& path) const {
    if (state_->is_failing()) return silpose::error("{}: Input/output error", path.string());
    if (path.parent_path() != folder_) return no_such(path);
    return {};
  }

  const std::filesystem::path folder_;
  const std::shared_ptr<State> state_;
};

}  // namespace sadb
