// What fuzz targets share. Threads: one.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "silpose/base/checked_file.h"
#include "silpose/base/state_bytes.h"

namespace silpose::fuzz {

inline std::string_view text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// A file in memory with these bytes, for readers that take a path; the next call changes it.
inline std::filesystem::path file_with(std::string_view bytes) {
  static const int file = memfd_create("fuzz", 0);
  if (file < 0 || ftruncate(file, 0) != 0) std::abort();
  if (pwrite(file, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) std::abort();
  return "/proc/self/fd/" + std::to_string(file);
}

// A checked file (base/checked_file.h) whose size and checksum are corrected: otherwise no input gets past them.
inline std::string sealed(std::string_view bytes) {
  constexpr size_t kHead = 12, kHeader = 24;  // magic and version; all of the header
  if (bytes.size() < kHeader) return std::string(bytes);
  const std::string_view payload = bytes.substr(kHeader);
  return std::string(bytes.substr(0, kHead)) + to_bytes(checksum(payload), uint64_t{payload.size()}) +
         std::string(payload);
}

}  // namespace silpose::fuzz
