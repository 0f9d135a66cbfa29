// MemoryStore: a blackboard in this process's memory, lost when it ends.
// Locks are held to find or place an entry, never while a value is copied; a value is shared once it is placed.
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

  silpose::Result<void> put(const std::string& path, int64_t time_ns, Value value) override;
  silpose::Result<Reading> get(const std::string& path, int64_t time_ns, Method method) const override;
  silpose::Result<std::vector<Entry>> range(const std::string& path, int64_t from_ns, int64_t to_ns) const override;
  [[nodiscard]] std::vector<PathInfo> list(const std::string& prefix) const override;
  [[nodiscard]] int64_t count(const std::string& path) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sadb
