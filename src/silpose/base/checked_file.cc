#include "silpose/base/checked_file.h"

#include <zlib.h>

#include <bit>

#include "silpose/base/check.h"
#include "silpose/base/state_bytes.h"
#include "silpose/base/text_file.h"

namespace silpose {

static_assert(std::endian::native == std::endian::little, "numbers are copied byte by byte");

uint32_t checksum(std::string_view bytes) {
  return static_cast<uint32_t>(
      crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

Result<void> write_checked_file(const std::filesystem::path& path, const FileKind& kind, std::string_view payload) {
  check(kind.magic.size() == 8, "write_checked_file: magic '{}'", kind.magic);
  std::string file(kind.magic);
  file += to_bytes(kind.version, checksum(payload), uint64_t{payload.size()});
  file += payload;
  return write_text_file(path, file);
}

Result<std::string> read_checked_file(const std::filesystem::path& path, const FileKind& kind) {
  Result<std::string> file = read_text_file(path);
  if (!file) return file;
  std::string_view bytes = *file;
  if (bytes.empty()) return error("{}: empty", path.string());
  if (!bytes.starts_with(kind.magic)) return error("{}: not a {}", path.string(), kind.name);
  bytes.remove_prefix(kind.magic.size());
  uint32_t version = 0, expected = 0;
  uint64_t size = 0;
  constexpr size_t kNumbers = sizeof version + sizeof expected + sizeof size;
  if (!from_bytes(bytes.substr(0, kNumbers), version, expected, size)) return error("{}: truncated", path.string());
  bytes.remove_prefix(kNumbers);
  if (version < kind.oldest_version || version > kind.version) {
    return error("{}: {} of version {}, not {}", path.string(), kind.name, version, kind.version);
  }
  if (bytes.size() < size) return error("{}: truncated", path.string());
  if (bytes.size() > size || checksum(bytes) != expected) return error("{}: damaged (checksum)", path.string());
  file->erase(0, file->size() - bytes.size());
  return file;
}

}  // namespace silpose
