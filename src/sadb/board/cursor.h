// Query, Cursor: the entries of a path over a span of time, page by page.
// Threads: one thread at a time per cursor; different cursors are independent.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sadb/board/entry.h"
#include "silpose/base/result.h"

namespace sadb {

// Which entries of a path: from_ns <= time <= to_ns, of these every stride-th beginning with the first, of these at
// most `limit`. REQUIRES: limit >= 0, stride >= 1.
struct Query {
  int64_t from_ns = std::numeric_limits<int64_t>::min();
  int64_t to_ns = std::numeric_limits<int64_t>::max();
  int64_t limit = std::numeric_limits<int64_t>::max();
  int64_t stride = 1;
};

class Cursor {
 public:
  static constexpr int64_t kPage = 256;  // guess: small beside a second of frames, large beside the cost of a call

  virtual ~Cursor() = default;

  // The next entries in order of time, max_entries of them or, at the end, fewer. An empty page is the end, and so is
  // every page after it. A page is the path as it is at one instant during the call; entries that are put between two
  // calls appear if they lie after the last one returned (the stride then counts them, too).
  // REQUIRES: max_entries >= 1. Errors: the path was removed.
  virtual silpose::Result<std::vector<Entry>> next(int64_t max_entries = kPage) = 0;
};

}  // namespace sadb
