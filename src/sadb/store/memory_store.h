// MemoryStore: a blackboard in this process's memory, lost when it ends.
// One lock guards everything. It is held to find, place and remove entries; values are made before it is taken, and
// copied, computed with and freed after it is released.
// Threads: as Blackboard.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sadb/board/blackboard.h"

namespace sadb {

class MemoryStore final : public Blackboard {
 public:
  MemoryStore();
  ~MemoryStore() override;

  silpose::Result<void> declare(const std::string& path, const Schema& schema) override;
  silpose::Result<Schema> schema(const std::string& path) const override;
  silpose::Result<void> put_batch(std::vector<PathEntry> batch) override;
  silpose::Result<Reading> get(const std::string& path, int64_t time_ns, TimeAccess access) const override;
  silpose::Result<std::vector<silpose::Result<Reading>>> snapshot(int64_t time_ns,
                                                                  const std::vector<Lookup>& lookups) const override;
  silpose::Result<std::unique_ptr<Cursor>> range(const std::string& path, const Query& query) const override;
  silpose::Result<std::unique_ptr<Subscription>> watch(const std::string& prefix, const WatchOptions& options) override;
  silpose::Result<void> remove(const std::string& path) override;
  silpose::Result<int64_t> remove_range(const std::string& path, int64_t from_ns, int64_t to_ns) override;
  silpose::Result<std::vector<PathInfo>> list(const std::string& prefix) const override;
  silpose::Result<int64_t> count(const std::string& path) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sadb
