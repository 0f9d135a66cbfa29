#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "sadb/files/file_system.h"
#include "silpose/base/check.h"

namespace sadb {
namespace {

namespace fs = std::filesystem;
using silpose::error;
using silpose::Result;

// "walk.log: No space left on device"
auto failure(const fs::path& path, int code = errno) {
  return error("{}: {}", path.string(), std::generic_category().message(code));
}

// The call again for as long as a signal interrupts it.
template <class Call>
auto uninterrupted(const Call& call) {
  while (true) {
    const auto result = call();
    if (result >= 0 || errno != EINTR) return result;
  }
}

// An open file, closed at the end.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags)
      : number_(uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0644); })) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  [[nodiscard]] bool is_open() const { return number_ >= 0; }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_ = -1;
};

class PosixFile final : public WritableFile {
 public:
  PosixFile(fs::path path, Descriptor file) : path_(std::move(path)), file_(std::move(file)) {}

  Result<void> append(std::string_view bytes) override {
    if (failed_) return after_failure();
    while (!bytes.empty()) {
      const ssize_t written = uninterrupted([&] { return ::write(file_.number(), bytes.data(), bytes.size()); });
      if (written < 0) return fail();
      bytes.remove_prefix(static_cast<size_t>(written));
    }
    return {};
  }

  Result<void> sync() override {
    if (failed_) return after_failure();
    if (::fsync(file_.number()) != 0) return fail();
    return {};
  }

 private:
  Result<void> fail() {
    failed_ = true;
    return failure(path_);
  }
  Result<void> after_failure() const { return error("{}: an earlier write failed", path_.string()); }

  const fs::path path_;
  const Descriptor file_;
  bool failed_ = false;
};

class PosixFileSystem final : public FileSystem {
 public:
  Result<std::unique_ptr<WritableFile>> create(const fs::path& path) override {
    Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL | O_APPEND);
    if (!file.is_open()) return failure(path);
    return std::unique_ptr<WritableFile>(std::make_unique<PosixFile>(path, std::move(file)));
  }

  Result<std::string> read(const fs::path& path, int64_t offset, int64_t max_bytes) const override {
    silpose::check(offset >= 0 && max_bytes >= 0, "read: {} bytes at {}", max_bytes, offset);
    const Descriptor file(path, O_RDONLY);
    struct stat status {};
    if (!file.is_open() || ::fstat(file.number(), &status) != 0) return failure(path);
    std::string bytes(static_cast<size_t>(std::clamp<int64_t>(status.st_size - offset, 0, max_bytes)), '\0');
    size_t filled = 0;
    while (filled < bytes.size()) {
      const ssize_t got = uninterrupted([&] {
        return ::pread(file.number(), bytes.data() + filled, bytes.size() - filled,
                       offset + static_cast<off_t>(filled));
      });
      if (got < 0) return failure(path);
      if (got == 0) break;
      filled += static_cast<size_t>(got);
    }
    bytes.resize(filled);
    return bytes;
  }

  Result<void> rename(const fs::path& from, const fs::path& to) override {
    silpose::check(from.parent_path() == to.parent_path(), "rename: {} to {}, another folder", from.string(),
                   to.string());
    if (::rename(from.c_str(), to.c_str()) != 0) return failure(from);
    return {};
  }

  Result<void> remove(const fs::path& path) override {
    if (::unlink(path.c_str()) != 0) return failure(path);
    return {};
  }

  Result<std::vector<std::string>> list(const fs::path& folder) const override {
    std::vector<std::string> names;
    std::error_code code;
    fs::directory_iterator at(folder, code);
    for (; !code && at != fs::directory_iterator(); at.increment(code)) {
      if (at->is_regular_file(code)) names.push_back(at->path().filename().string());
      if (code) break;
    }
    if (code) return error("{}: {}", folder.string(), code.message());
    std::ranges::sort(names);
    return names;
  }

  Result<void> sync_folder(const fs::path& folder) override {
    const Descriptor file(folder, O_RDONLY | O_DIRECTORY);
    if (!file.is_open() || ::fsync(file.number()) != 0) return failure(folder);
    return {};
  }
};

}  // namespace

std::unique_ptr<FileSystem> posix_file_system() { return std::make_unique<PosixFileSystem>(); }

}  // namespace sadb
