#include "sadb/store/memory_store.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "sadb/store/series.h"
#include "sadb/store/watch_queue.h"
#include "silpose/base/check.h"

namespace sadb {
namespace {

using silpose::error;
using silpose::Result;

using SeriesMap = std::map<std::string, std::shared_ptr<Series>>;

// The entries about an instant and the series they are of; without a series where there is none.
struct Found {
  std::shared_ptr<const Series> series;
  Series::Found entries;

  Result<Reading> reading(const std::string& path, int64_t time_ns, TimeAccess access) const {
    if (!series) return error("{}: no such path", path);
    const Neighbours neighbours = {entries.at_or_before.get(), entries.at_or_after.get(), entries.latest.get()};
    Result<Reading> reading = read_at(neighbours, time_ns, access, series->schema);
    if (!reading) return error("{}: {}", path, reading.error().message);
    return reading;
  }
};

}  // namespace

struct MemoryStore::Impl {
  mutable std::mutex mutex;
  SeriesMap series;
  std::vector<std::weak_ptr<WatchQueue>> watchers;

  // All of these REQUIRE the lock.
  std::shared_ptr<Series> find(const std::string& path) const {
    const auto found = series.find(path);
    return found == series.end() ? nullptr : found->second;
  }
  Found find(const std::string& path, int64_t time_ns) const {
    const std::shared_ptr<Series> at = find(path);
    return {at, at ? at->about(time_ns) : Series::Found{}};
  }
  // The series that an entry of a batch goes into, one of `fresh` where the path is new.
  Result<std::shared_ptr<Series>> series_for(const std::string& path, const Value& value, SeriesMap& fresh) const {
    std::shared_ptr<Series> at = find(path);
    if (!at) {
      const auto found = fresh.find(path);
      if (found != fresh.end()) at = found->second;
    }
    if (!at) {
      if (Result<void> valid = check_path(path); !valid) return valid.failure();
      at = std::make_shared<Series>(path, Schema{type_of(value)});
      fresh.emplace(path, at);
    }
    if (Result<void> fits = check_value(at->schema, value); !fits) return error("{}: {}", path, fits.error().message);
    return at;
  }
  void notify(const std::vector<Placement>& put) const {
    for (const std::weak_ptr<WatchQueue>& watcher : watchers) {
      if (const std::shared_ptr<WatchQueue> queue = watcher.lock()) queue->offer(put);
    }
  }

  class PagedRange;
  class Watch;
};

class MemoryStore::Impl::PagedRange final : public Cursor {
 public:
  PagedRange(const Impl& store, std::string path, const Query& query)
      : store_(store), path_(std::move(path)), query_(query) {}

  Result<std::vector<Entry>> next(int64_t max_entries) override {
    silpose::check(max_entries >= 1, "Cursor: a page of {} entries", max_entries);
    if (at_end_) return std::vector<Entry>{};
    std::vector<SharedEntry> page;
    {
      const std::lock_guard lock(store_.mutex);
      const std::shared_ptr<Series> series = store_.find(path_);
      if (!series) return error("{}: no such path", path_);
      page = series->page(query_.from_ns, query_.to_ns, skip_, query_.stride, std::min(max_entries, query_.limit));
    }
    at_end_ = page.empty() || page.back()->time_ns == std::numeric_limits<int64_t>::max();
    if (!page.empty()) {
      query_.limit -= static_cast<int64_t>(page.size());
      skip_ = query_.stride - 1;
      if (!at_end_) query_.from_ns = page.back()->time_ns + 1;
    }
    std::vector<Entry> entries;
    entries.reserve(page.size());
    for (const SharedEntry& entry : page) entries.push_back(*entry);
    return entries;
  }

 private:
  const Impl& store_;
  const std::string path_;
  Query query_;       // what is still to be read
  int64_t skip_ = 0;  // entries of it to leave out first
  bool at_end_ = false;
};

class MemoryStore::Impl::Watch final : public Subscription {
 public:
  explicit Watch(std::shared_ptr<WatchQueue> queue) : queue_(std::move(queue)) {}

  Result<Update> next(std::chrono::nanoseconds timeout) override { return queue_->next(timeout); }

 private:
  std::shared_ptr<WatchQueue> queue_;  // the store holds it weakly
};

MemoryStore::MemoryStore() : impl_(std::make_unique<Impl>()) {}
MemoryStore::~MemoryStore() = default;

Result<void> MemoryStore::declare(const std::string& path, const Schema& schema) {
  if (Result<void> valid = check_path(path); !valid) return valid;
  if (Result<void> valid = check_schema(schema); !valid) return error("{}: {}", path, valid.error().message);
  auto fresh = std::make_shared<Series>(path, schema);
  const std::lock_guard lock(impl_->mutex);
  const auto [at, is_new] = impl_->series.try_emplace(path, std::move(fresh));
  if (!is_new && at->second->schema != schema) return error("{}: has another schema already", path);
  return {};
}

Result<Schema> MemoryStore::schema(const std::string& path) const {
  std::shared_ptr<const Series> series;
  {
    const std::lock_guard lock(impl_->mutex);
    series = impl_->find(path);
  }
  if (!series) return error("{}: no such path", path);
  return series->schema;
}

Result<void> MemoryStore::put_batch(std::vector<PathEntry> batch) {
  std::vector<Placement> put;
  put.reserve(batch.size());
  for (PathEntry& entry : batch) {
    put.push_back({nullptr, std::make_shared<const Entry>(Entry{entry.time_ns, std::move(entry.value)})});
  }
  std::vector<SharedEntry> replaced;  // freed after the lock
  const std::lock_guard lock(impl_->mutex);
  SeriesMap fresh;
  for (size_t i = 0; i < batch.size(); ++i) {
    Result<std::shared_ptr<Series>> series = impl_->series_for(batch[i].path, put[i].entry->value, fresh);
    if (!series) return series.failure();
    put[i].series = *std::move(series);
  }
  impl_->series.merge(fresh);
  for (const Placement& placement : put) {
    SharedEntry before = placement.series->place(placement.entry);
    if (before) replaced.push_back(std::move(before));
  }
  impl_->notify(put);
  return {};
}

Result<Reading> MemoryStore::get(const std::string& path, int64_t time_ns, TimeAccess access) const {
  Found found;
  {
    const std::lock_guard lock(impl_->mutex);
    found = impl_->find(path, time_ns);
  }
  return found.reading(path, time_ns, access);
}

Result<std::vector<Result<Reading>>> MemoryStore::snapshot(int64_t time_ns, const std::vector<Lookup>& lookups) const {
  std::vector<Found> found;
  found.reserve(lookups.size());
  {
    const std::lock_guard lock(impl_->mutex);
    for (const Lookup& lookup : lookups) found.push_back(impl_->find(lookup.path, time_ns));
  }
  std::vector<Result<Reading>> readings;
  readings.reserve(lookups.size());
  for (size_t i = 0; i < lookups.size(); ++i) {
    readings.push_back(found[i].reading(lookups[i].path, time_ns, lookups[i].access));
  }
  return readings;
}

Result<std::unique_ptr<Cursor>> MemoryStore::range(const std::string& path, const Query& query) const {
  silpose::check(query.limit >= 0 && query.stride >= 1, "range: limit {}, stride {}", query.limit, query.stride);
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->find(path)) return error("{}: no such path", path);
  return std::unique_ptr<Cursor>(std::make_unique<Impl::PagedRange>(*impl_, path, query));
}

Result<std::unique_ptr<Subscription>> MemoryStore::watch(const std::string& prefix, const WatchOptions& options) {
  silpose::check(options.capacity >= 1, "watch: capacity {}", options.capacity);
  auto queue = std::make_shared<WatchQueue>(prefix, options.capacity);
  const std::lock_guard lock(impl_->mutex);
  std::erase_if(impl_->watchers, [](const std::weak_ptr<WatchQueue>& watcher) { return watcher.expired(); });
  impl_->watchers.push_back(queue);
  return std::unique_ptr<Subscription>(std::make_unique<Impl::Watch>(std::move(queue)));
}

Result<void> MemoryStore::remove(const std::string& path) {
  SeriesMap::node_type removed;  // freed after the lock
  const std::lock_guard lock(impl_->mutex);
  removed = impl_->series.extract(path);
  if (removed.empty()) return error("{}: no such path", path);
  return {};
}

Result<int64_t> MemoryStore::remove_range(const std::string& path, int64_t from_ns, int64_t to_ns) {
  std::vector<SharedEntry> removed;  // freed after the lock
  const std::lock_guard lock(impl_->mutex);
  const std::shared_ptr<Series> series = impl_->find(path);
  if (!series) return error("{}: no such path", path);
  removed = series->take(from_ns, to_ns);
  return static_cast<int64_t>(removed.size());
}

Result<std::vector<PathInfo>> MemoryStore::list(const std::string& prefix) const {
  std::vector<PathInfo> infos;
  const std::lock_guard lock(impl_->mutex);
  for (auto at = impl_->series.lower_bound(prefix); at != impl_->series.end() && at->first.starts_with(prefix); ++at) {
    if (is_at_or_below(at->first, prefix)) infos.push_back(at->second->info());
  }
  return infos;
}

Result<int64_t> MemoryStore::count(const std::string& path) const {
  const std::lock_guard lock(impl_->mutex);
  const std::shared_ptr<Series> series = impl_->find(path);
  return series ? series->size() : 0;
}

}  // namespace sadb
