// Series: the entries of one path in memory, in order of time, and the path's schema.
// Threads: none of its own; MemoryStore's lock guards all but `path` and `schema`, which never change.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sadb/board/blackboard.h"

namespace sadb {

using SharedEntry = std::shared_ptr<const Entry>;

class Series {
 public:
  Series(std::string path_of, Schema schema_of) : path(std::move(path_of)), schema(std::move(schema_of)) {}

  const std::string path;
  const Schema schema;

  // Places an entry; returns the one whose place it takes, so that the caller can free it outside of its lock.
  SharedEntry place(SharedEntry entry) {
    const auto at = entries_.begin() + first_at_or_after(entry->time_ns);
    if (at == entries_.end() || (*at)->time_ns != entry->time_ns) {
      entries_.insert(at, std::move(entry));
      return nullptr;
    }
    at->swap(entry);
    return entry;
  }

  struct Found {
    SharedEntry at_or_before, at_or_after, latest;
  };
  [[nodiscard]] Found about(int64_t time_ns) const {
    Found found;
    if (entries_.empty()) return found;
    found.latest = entries_.back();
    const int64_t at = first_at_or_after(time_ns);
    if (at < size()) found.at_or_after = entry(at);
    if (at < size() && entry(at)->time_ns == time_ns) {
      found.at_or_before = found.at_or_after;
    } else if (at > 0) {
      found.at_or_before = entry(at - 1);
    }
    return found;
  }

  // Of the entries in [from_ns, to_ns] without the first `skip`: every stride-th, at most `limit`.
  [[nodiscard]] std::vector<SharedEntry> page(int64_t from_ns, int64_t to_ns, int64_t skip, int64_t stride,
                                              int64_t limit) const {
    std::vector<SharedEntry> page;
    const int64_t end = from_ns <= to_ns ? first_after(to_ns) : 0;
    int64_t at = first_at_or_after(from_ns);
    if (at >= end || skip >= end - at) return page;
    at += skip;
    while (static_cast<int64_t>(page.size()) < limit) {
      page.push_back(entry(at));
      if (stride >= end - at) break;
      at += stride;
    }
    return page;
  }

  // Takes the entries in [from_ns, to_ns] out.
  std::vector<SharedEntry> take(int64_t from_ns, int64_t to_ns) {
    if (from_ns > to_ns) return {};
    const auto first = entries_.begin() + first_at_or_after(from_ns), last = entries_.begin() + first_after(to_ns);
    std::vector<SharedEntry> taken(std::make_move_iterator(first), std::make_move_iterator(last));
    entries_.erase(first, last);
    return taken;
  }

  [[nodiscard]] PathInfo info() const {
    PathInfo info{path, schema.type, size(), 0, 0};
    if (!entries_.empty()) {
      info.first_ns = entries_.front()->time_ns;
      info.last_ns = entries_.back()->time_ns;
    }
    return info;
  }

  [[nodiscard]] int64_t size() const { return static_cast<int64_t>(entries_.size()); }

 private:
  [[nodiscard]] const SharedEntry& entry(int64_t index) const { return entries_[static_cast<size_t>(index)]; }

  // Indices, size() where there is none.
  [[nodiscard]] int64_t first_at_or_after(int64_t time_ns) const {
    // Most writers and readers are at the end.
    if (entries_.empty() || entries_.back()->time_ns < time_ns) return size();
    const auto is_before = [](const SharedEntry& entry, int64_t time) { return entry->time_ns < time; };
    return std::lower_bound(entries_.begin(), entries_.end(), time_ns, is_before) - entries_.begin();
  }
  [[nodiscard]] int64_t first_after(int64_t time_ns) const {
    return time_ns == std::numeric_limits<int64_t>::max() ? size() : first_at_or_after(time_ns + 1);
  }

  // Not a vector: retention removes at the front.
  std::deque<SharedEntry> entries_;
};

}  // namespace sadb
