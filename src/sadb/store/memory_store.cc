#include "sadb/store/memory_store.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <utility>

namespace sadb {
namespace {

using silpose::error;
using silpose::Result;
using SharedEntry = std::shared_ptr<const Entry>;

// The entries of one path, in order of time.
class Series {
 public:
  explicit Series(Type type) : type_(type) {}

  Type type() const { return type_; }

  void put(SharedEntry entry) {
    const std::lock_guard lock(mutex_);
    const auto at = first_at_or_after(entry->time_ns);
    if (at != entries_.end() && (*at)->time_ns == entry->time_ns) {
      // Swapped, so that what was there is freed after the lock.
      entries_[static_cast<size_t>(at - entries_.begin())].swap(entry);
    } else {
      entries_.insert(at, std::move(entry));
    }
  }

  struct Found {
    SharedEntry at_or_before, at_or_after, latest;
  };
  Found about(int64_t time_ns) const {
    const std::lock_guard lock(mutex_);
    Found found;
    if (entries_.empty()) return found;
    found.latest = entries_.back();
    const auto at = first_at_or_after(time_ns);
    if (at != entries_.end()) found.at_or_after = *at;
    if (found.at_or_after && found.at_or_after->time_ns == time_ns) {
      found.at_or_before = found.at_or_after;
    } else if (at != entries_.begin()) {
      found.at_or_before = *std::prev(at);
    }
    return found;
  }

  // The first few entries of [from_ns, to_ns]: a long range is read in pieces, so that writers come in between.
  std::vector<SharedEntry> some_of(int64_t from_ns, int64_t to_ns) const {
    constexpr size_t kPiece = 256;
    const std::lock_guard lock(mutex_);
    std::vector<SharedEntry> piece;
    for (auto at = first_at_or_after(from_ns); at != entries_.end() && (*at)->time_ns <= to_ns; ++at) {
      if (piece.size() == kPiece) break;
      piece.push_back(*at);
    }
    return piece;
  }

  PathInfo info(const std::string& path) const {
    const std::lock_guard lock(mutex_);
    PathInfo info{path, type_, static_cast<int64_t>(entries_.size()), 0, 0};
    if (!entries_.empty()) {
      info.first_ns = entries_.front()->time_ns;
      info.last_ns = entries_.back()->time_ns;
    }
    return info;
  }

 private:
  // REQUIRES: the lock.
  std::vector<SharedEntry>::const_iterator first_at_or_after(int64_t time_ns) const {
    // Most writers and readers are at the end.
    if (!entries_.empty() && entries_.back()->time_ns < time_ns) return entries_.end();
    return std::lower_bound(entries_.begin(), entries_.end(), time_ns,
                            [](const SharedEntry& entry, int64_t time) { return entry->time_ns < time; });
  }

  const Type type_;
  mutable std::mutex mutex_;
  std::vector<SharedEntry> entries_;
};

}  // namespace

struct MemoryStore::Impl {
  // Guards the map alone; it is written only when a path is new.
  mutable std::shared_mutex mutex;
  std::map<std::string, std::shared_ptr<Series>> series;

  std::shared_ptr<Series> find(const std::string& path) const {
    const std::shared_lock lock(mutex);
    const auto found = series.find(path);
    return found == series.end() ? nullptr : found->second;
  }
};

MemoryStore::MemoryStore() : impl_(std::make_unique<Impl>()) {}
MemoryStore::~MemoryStore() = default;

Result<void> MemoryStore::put(const std::string& path, int64_t time_ns, Value value) {
  const Type type = type_of(value);
  auto entry = std::make_shared<const Entry>(Entry{time_ns, std::move(value)});
  std::shared_ptr<Series> series = impl_->find(path);
  if (!series) {
    if (Result<void> valid = check_path(path); !valid) return valid.failure();
    // The first entry comes with the series: no reader sees a path without entries.
    auto fresh = std::make_shared<Series>(type);
    fresh->put(entry);
    const std::lock_guard lock(impl_->mutex);
    const auto [at, is_new] = impl_->series.try_emplace(path, std::move(fresh));
    if (is_new) return {};
    series = at->second;
  }
  if (series->type() != type)
    return error("{}: is of type {}, not {}", path, type_name(series->type()), type_name(type));
  series->put(std::move(entry));
  return {};
}

Result<Reading> MemoryStore::get(const std::string& path, int64_t time_ns, Method method) const {
  const std::shared_ptr<Series> series = impl_->find(path);
  if (!series) return error("{}: no such path", path);
  const Series::Found found = series->about(time_ns);
  Result<Reading> reading =
      read_at({found.at_or_before.get(), found.at_or_after.get(), found.latest.get()}, time_ns, method);
  if (!reading) return error("{}: {}", path, reading.error().message);
  return reading;
}

Result<std::vector<Entry>> MemoryStore::range(const std::string& path, int64_t from_ns, int64_t to_ns) const {
  const std::shared_ptr<Series> series = impl_->find(path);
  if (!series) return error("{}: no such path", path);
  std::vector<Entry> entries;
  while (from_ns <= to_ns) {
    const std::vector<SharedEntry> piece = series->some_of(from_ns, to_ns);
    if (piece.empty()) break;
    for (const SharedEntry& entry : piece) entries.push_back(*entry);
    if (piece.back()->time_ns == std::numeric_limits<int64_t>::max()) break;
    from_ns = piece.back()->time_ns + 1;
  }
  return entries;
}

std::vector<PathInfo> MemoryStore::list(const std::string& prefix) const {
  std::vector<std::pair<std::string, std::shared_ptr<Series>>> found;
  {
    const std::shared_lock lock(impl_->mutex);
    for (auto at = impl_->series.lower_bound(prefix); at != impl_->series.end() && at->first.starts_with(prefix);
         ++at) {
      if (is_at_or_below(at->first, prefix)) found.emplace_back(*at);
    }
  }
  std::vector<PathInfo> infos;
  infos.reserve(found.size());
  for (const auto& [path, series] : found) infos.push_back(series->info(path));
  return infos;
}

int64_t MemoryStore::count(const std::string& path) const {
  const std::shared_ptr<Series> series = impl_->find(path);
  return series ? series->info(path).count : 0;
}

}  // namespace sadb
