#include "sadb/board/blackboard.h"

#include <algorithm>

namespace sadb {

silpose::Result<void> check_path(std::string_view path) {
  if (path.empty()) return silpose::error("path '': empty");
  if (path.front() == '/' || path.back() == '/' || path.find("//") != std::string_view::npos) {
    return silpose::error("path '{}': has an empty segment", path);
  }
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::any_of(path.begin(), path.end(), is_control)) {
    return silpose::error("path of {} bytes: has a control character", path.size());
  }
  return {};
}

bool is_at_or_below(std::string_view path, std::string_view prefix) {
  if (prefix.empty() || path == prefix) return true;
  if (!path.starts_with(prefix)) return false;
  return prefix.back() == '/' || path[prefix.size()] == '/';
}

}  // namespace sadb
