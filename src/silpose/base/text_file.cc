#include "silpose/base/text_file.h"

#include <fstream>
#include <system_error>

namespace silpose {

Result<std::string> read_text_file(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) return error("{}: no such file", path.string());
  if (std::filesystem::is_directory(status)) return error("{}: a directory, not a file", path.string());
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return error("{}: cannot be read", path.string());
  std::string text;
  char block[1 << 16];
  while (stream.read(block, sizeof block) || stream.gcount() > 0) {
    text.append(block, static_cast<size_t>(stream.gcount()));
  }
  if (stream.bad()) return error("{}: cannot be read", path.string());
  return text;
}

Result<void> write_text_file(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path partial = path;
  partial += ".tmp";
  std::error_code code;
  {
    std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
    if (!stream) return error("{}: cannot be written", path.string());
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    if (!stream) {
      std::filesystem::remove(partial, code);
      return error("{}: cannot be written (disk full?)", path.string());
    }
  }
  std::filesystem::rename(partial, path, code);
  if (code) {
    const std::string reason = code.message();
    std::filesystem::remove(partial, code);
    return error("{}: cannot be written: {}", path.string(), reason);
  }
  return {};
}

}  // namespace silpose
