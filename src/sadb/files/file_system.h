// FileSystem: all that a store on disk asks of the operating system, so that tests can put one in its place that fails
// or forgets what a crash would lose (fault_injection_for_test.h).
//
// Contract, for every implementation (tested by file_system_contract_test.cc):
// - Bytes survive a crash once sync() has returned without an error after they were appended, provided that the file's
//   name survives. A name that was created, renamed or removed stays so once sync_folder() has returned without an
//   error after it. What is not yet synced may survive a crash in part: any number of a file's first bytes.
// - A rename is atomic: another process, and a crash, see the old file of that name or the new one.
// - An operation that fails has changed nothing, with one exception: part of the bytes of a failed append() may be in
//   the file. After append() or sync() has failed, every later call on that WritableFile fails: the result of a second
//   fsync() after a failed one means nothing (rebello2020).
// - Folders exist beforehand; none is made here.
// - Errors name the file and the reason.
// Threads: any number of threads may call a FileSystem; one thread at a time may call a WritableFile.
//
// Based on: the environment and its fault injection of LevelDB (references.bib: leveldb).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"

namespace sadb {

// Grows at its end. Destroying it closes it, without sync().
class WritableFile {
 public:
  virtual ~WritableFile() = default;

  // Appends all bytes. Errors: disk full, too large.
  virtual silpose::Result<void> append(std::string_view bytes) = 0;

  // Errors: the device did not take the bytes.
  virtual silpose::Result<void> sync() = 0;
};

class FileSystem {
 public:
  virtual ~FileSystem() = default;

  // A new, empty file. Errors: there is one of that name; no such folder.
  virtual silpose::Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) = 0;

  // Up to `max_bytes` from `offset` on; fewer only at the end of the file. Errors: no such file.
  virtual silpose::Result<std::string> read(const std::filesystem::path& path, int64_t offset,
                                            int64_t max_bytes) const = 0;

  // Replaces a file that is called `to`. REQUIRES: both in one folder. Errors: no such file.
  virtual silpose::Result<void> rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;

  // Errors: no such file.
  virtual silpose::Result<void> remove(const std::filesystem::path& path) = 0;

  // Names of the files in a folder, sorted; not of folders in it. Errors: no such folder.
  virtual silpose::Result<std::vector<std::string>> list(const std::filesystem::path& folder) const = 0;

  // Errors: no such folder; the device did not take it.
  virtual silpose::Result<void> sync_folder(const std::filesystem::path& folder) = 0;
};

// The files of this machine, by POSIX calls.
[[nodiscard]] std::unique_ptr<FileSystem> posix_file_system();

}  // namespace sadb
