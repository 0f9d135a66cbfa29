#include "silpose/base/data_folder.h"

#include <cstdlib>
#include <system_error>

namespace silpose {
namespace {

namespace fs = std::filesystem;

// Empty where it is not set.
fs::path data_of_environment() {
  const char* set = std::getenv("SILPOSE_DATA");
  return set != nullptr ? set : "";
}

fs::path installed_share() {
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  return program.parent_path().parent_path() / "share" / "silpose";
}

}  // namespace

fs::path data_directory() {
  if (const fs::path set = data_of_environment(); !set.empty()) return set;
  std::error_code failed;
  const fs::path share = installed_share();
  return fs::is_directory(share, failed) ? share : fs::path(SILPOSE_DATA_DIR);
}

fs::path experiments_directory() {
  std::error_code failed;
  for (const fs::path& data : {data_of_environment(), installed_share()}) {
    if (!data.empty() && fs::is_directory(data / "experiments", failed)) return data / "experiments";
  }
  return SILPOSE_EXPERIMENTS_DIR;
}

}  // namespace silpose
