// Blackboard: time-coded values by path, written and read by any number of knowledge sources.
//
// Contract, for every implementation:
// - A path is segments joined by '/', such as "tracker/pose": segments are not empty, hold no control characters, and
//   nothing precedes the first or follows the last.
// - The type of a path is that of its first entry; an entry of another type is refused.
// - Entries may come in any order of time. One with the time of an entry that is there takes its place.
// - What put() has taken is seen by every get(), range(), list() and count() that starts after it returned.
// - Any number of threads may call anything at once. A writer does not wait while readers copy values out; a range()
//   during writes returns each entry as it was at some instant during the call.
// - Values are copied in and out: nothing that was returned changes later.
//
// Based on: thesis section 3.3 (references.bib: cormier2019).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sadb/board/entry.h"
#include "sadb/board/time_access.h"
#include "silpose/base/result.h"

namespace sadb {

struct PathInfo {
  std::string path;
  Type type = Type::kScalar;
  int64_t count = 0;
  int64_t first_ns = 0, last_ns = 0;
};

class Blackboard {
 public:
  virtual ~Blackboard() = default;

  // Errors: malformed path; type other than the path's. Each names the path.
  virtual silpose::Result<void> put(const std::string& path, int64_t time_ns, Value value) = 0;

  // Errors: no such path; those of read_at (time_access.h). Each names the path.
  virtual silpose::Result<Reading> get(const std::string& path, int64_t time_ns, Method method) const = 0;

  // Entries in order of time with from_ns <= time <= to_ns. Errors: no such path.
  virtual silpose::Result<std::vector<Entry>> range(const std::string& path, int64_t from_ns, int64_t to_ns) const = 0;

  // Paths that are `prefix` or lie below it, sorted; all paths for "".
  [[nodiscard]] virtual std::vector<PathInfo> list(const std::string& prefix) const = 0;

  // Entries of a path; 0 when there is no such path.
  [[nodiscard]] virtual int64_t count(const std::string& path) const = 0;
};

// The rule for paths in the contract. Errors: names the path and what is wrong.
silpose::Result<void> check_path(std::string_view path);

// Whether `path` is `prefix` or lies below it.
[[nodiscard]] bool is_at_or_below(std::string_view path, std::string_view prefix);

}  // namespace sadb
