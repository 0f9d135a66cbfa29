// Binary files whose integrity can be checked: a header with magic (8 bytes), version (uint32), CRC-32 of the payload
// (uint32) and its size (uint64), then the payload. Little-endian. Written as write_text_file() does.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "silpose/base/result.h"

namespace silpose {

struct FileKind {
  std::string_view magic;  // 8 characters
  uint32_t version = 1;
  std::string_view name;              // for messages: "body file"
  uint32_t oldest_version = version;  // that can still be read
};

// The CRC-32 of zlib.
uint32_t checksum(std::string_view bytes);

// Errors: those of write_text_file().
Result<void> write_checked_file(const std::filesystem::path& path, const FileKind& kind, std::string_view payload);

// The payload. Errors: missing, empty, of another kind or version, truncated, checksum; each names the file.
Result<std::string> read_checked_file(const std::filesystem::path& path, const FileKind& kind);

}  // namespace silpose
