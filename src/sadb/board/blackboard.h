// Blackboard: time-coded values by path, written and read by any number of knowledge sources.
//
// Contract, for every implementation (tested by blackboard_contract_for_test.h):
// - A path is segments joined by '/', such as "tracker/pose": segments are not empty, hold no control characters, and
//   nothing precedes the first or follows the last.
// - A path has one schema (schema.h), fixed by whichever comes first: declare(), or the first entry. An entry fixes the
//   type alone: poses of any skeleton, none of their values periodic. What contradicts the schema is refused.
// - Entries may come in any order of time. One with the time of an entry that is there takes its place.
// - A batch is taken as a whole or, with an error, not at all. No call sees a part of it: not snapshot(), list(), the
//   page of a cursor, nor the update of a subscription.
// - What put() has taken is seen by every call that starts after it returned.
// - Any number of threads may call anything at once. A writer does not wait while readers compute or copy values.
// - Nothing that was returned changes later.
// - The board outlives its cursors and subscriptions.
// - Every call may fail for reasons of its own: a disk, a connection. In memory only the errors below occur. Each names
//   the path.
//
// Based on: thesis section 3.3 (references.bib: cormier2019).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sadb/board/cursor.h"
#include "sadb/board/entry.h"
#include "sadb/board/schema.h"
#include "sadb/board/subscription.h"
#include "sadb/board/time_access.h"
#include "silpose/base/result.h"

namespace sadb {

struct PathInfo {
  std::string path;
  Type type = Type::kScalar;
  int64_t count = 0;                  // 0 where the path is declared only, or its entries were removed
  int64_t first_ns = 0, last_ns = 0;  // 0 without entries
};

// One value of a snapshot.
struct Lookup {
  std::string path;
  TimeAccess access;
};

class Blackboard {
 public:
  virtual ~Blackboard() = default;

  // Fixes the schema of a path before its first entry. Declaring it again is allowed if nothing differs.
  // Errors: malformed path; check_schema(); the path has another schema already.
  virtual silpose::Result<void> declare(const std::string& path, const Schema& schema) = 0;

  // Errors: no such path.
  virtual silpose::Result<Schema> schema(const std::string& path) const = 0;

  // Takes all entries or none, as if put one after the other at one instant. An empty batch is allowed.
  // Errors: malformed path; check_value(), by the schema that the path has or gets by an earlier entry of the batch.
  virtual silpose::Result<void> put_batch(std::vector<PathEntry> batch) = 0;

  // A batch of one.
  silpose::Result<void> put(std::string path, int64_t time_ns, Value value);

  // Errors: no such path; those of read_at (time_access.h).
  virtual silpose::Result<Reading> get(const std::string& path, int64_t time_ns, TimeAccess access) const = 0;

  // Several values at one instant, all from the same state of the board. [lookups.size()], each what get() gives: a
  // path that cannot answer does not spoil the others.
  virtual silpose::Result<std::vector<silpose::Result<Reading>>> snapshot(int64_t time_ns,
                                                                          const std::vector<Lookup>& lookups) const = 0;

  // Reads a path from the query's beginning. Errors: no such path. A query that breaks its rules throws
  // std::invalid_argument.
  virtual silpose::Result<std::unique_ptr<Cursor>> range(const std::string& path, const Query& query) const = 0;

  // Subscribes to the entries put from now on at `prefix` and below it; all of them for "". The paths need not exist.
  // Removals are not reported. A capacity below 1 throws std::invalid_argument.
  virtual silpose::Result<std::unique_ptr<Subscription>> watch(const std::string& prefix,
                                                               const WatchOptions& options) = 0;

  // Removes a path, its entries and its schema. Errors: no such path.
  virtual silpose::Result<void> remove(const std::string& path) = 0;

  // Removes the entries with from_ns <= time <= to_ns and returns how many; the path and its schema stay. With the
  // smallest int64 as from_ns this is retention. Errors: no such path.
  virtual silpose::Result<int64_t> remove_range(const std::string& path, int64_t from_ns, int64_t to_ns) = 0;

  // Paths that are `prefix` or lie below it, sorted; all paths for "".
  virtual silpose::Result<std::vector<PathInfo>> list(const std::string& prefix) const = 0;

  // Entries of a path; 0 when there is no such path.
  virtual silpose::Result<int64_t> count(const std::string& path) const = 0;
};

// All entries of a range, in memory at once. Errors: those of range() and of its cursor.
silpose::Result<std::vector<Entry>> read_range(const Blackboard& board, const std::string& path,
                                               const Query& query = {});

// The rule for paths in the contract. Errors: names the path and what is wrong.
silpose::Result<void> check_path(std::string_view path);

// Whether `path` is `prefix` or lies below it.
[[nodiscard]] bool is_at_or_below(std::string_view path, std::string_view prefix);

}  // namespace sadb
