#include "silpose/base/whole_file.h"

#include <system_error>

namespace silpose {

namespace fs = std::filesystem;

Result<void> write_whole(const fs::path& file, const std::function<Result<void>(const fs::path&)>& write) {
  std::error_code failed;
  if (fs::is_directory(file, failed)) return error("{}: is a directory", file.string());
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), failed);
  fs::path partial = file.parent_path() / (file.stem().string() + ".partial");
  partial += file.extension();
  const Result<void> written = write(partial);
  if (!written) {
    fs::remove(partial, failed);
    return error("{}: not writable ({})", file.string(), written.error().message);
  }
  fs::rename(partial, file, failed);
  if (failed) return error("{}: not writable ({})", file.string(), failed.message());
  return {};
}

}  // namespace silpose
