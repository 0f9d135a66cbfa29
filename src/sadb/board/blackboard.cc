#include "sadb/board/blackboard.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sadb {

silpose::Result<void> Blackboard::put(std::string path, int64_t time_ns, Value value) {
  std::vector<PathEntry> batch;
  batch.push_back({std::move(path), time_ns, std::move(value)});
  return put_batch(std::move(batch));
}

silpose::Result<std::vector<Entry>> read_range(const Blackboard& board, const std::string& path, const Query& query) {
  const silpose::Result<std::unique_ptr<Cursor>> cursor = board.range(path, query);
  if (!cursor) return cursor.failure();
  std::vector<Entry> entries;
  while (true) {
    silpose::Result<std::vector<Entry>> page = (*cursor)->next();
    if (!page) return page.failure();
    if (page->empty()) return entries;
    std::move(page->begin(), page->end(), std::back_inserter(entries));
  }
}

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
