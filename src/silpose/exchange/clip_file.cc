#include "silpose/exchange/clip_file.h"

#include <cctype>
#include <string>

#include "silpose/exchange/bvh.h"
#include "silpose/exchange/humanoid3d.h"

namespace silpose {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace

bool is_clip_file(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".bvh" || extension == ".txt";
}

Result<Clip> read_clip(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".bvh") return read_bvh(path);
  if (extension == ".txt") return read_humanoid3d(path);
  return error("{}: motion is read from .bvh and .txt (humanoid3d) files", path.string());
}

}  // namespace silpose
