// The contract of file_system.h, over every implementation; and what only the one of the machine can show.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <functional>
#include <limits>
#include <thread>

#include "sadb/files/fault_injection_for_test.h"
#include "sadb/files/file_system.h"
#include "silpose/base/folder_for_test.h"

namespace sadb {
namespace {

using silpose::Result;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr int64_t kAll = std::numeric_limits<int64_t>::max();

struct Implementation {
  const char* name;
  std::function<std::unique_ptr<FileSystem>(const fs::path&)> make;
};

class FileSystemContract : public silpose::FolderTest, public testing::WithParamInterface<Implementation> {
 protected:
  std::unique_ptr<FileSystem> files_ = GetParam().make(folder_);

  std::string contents(const char* name) const { return files_->read(folder_ / name, 0, kAll).value(); }
  void write(const char* name, std::string_view bytes) {
    const auto file = files_->create(folder_ / name).value();
    ASSERT_TRUE(file->append(bytes));
    ASSERT_TRUE(file->sync());
  }
  // The message of a failure, which must name the file.
  template <class T>
  void expect_failure(const Result<T>& result, const char* name) const {
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(result.error().message, HasSubstr(name));
  }
};

TEST_P(FileSystemContract, GivesBackWhatWasAppended) {
  const auto file = files_->create(folder_ / "log").value();
  EXPECT_EQ(contents("log"), "");
  ASSERT_TRUE(file->append("one "));
  ASSERT_TRUE(file->append(""));
  ASSERT_TRUE(file->append(std::string("t\0o", 3)));
  EXPECT_EQ(contents("log"), std::string("one t\0o", 7));
  ASSERT_TRUE(file->sync());
  ASSERT_TRUE(file->append("!"));
  EXPECT_EQ(contents("log"), std::string("one t\0o!", 8));
}

TEST_P(FileSystemContract, ReadsPieces) {
  write("log", "0123456789");
  const fs::path path = folder_ / "log";
  EXPECT_EQ(files_->read(path, 3, 4).value(), "3456");
  EXPECT_EQ(files_->read(path, 8, 100).value(), "89");
  EXPECT_EQ(files_->read(path, 10, 1).value(), "");
  EXPECT_EQ(files_->read(path, kAll, kAll).value(), "");
  EXPECT_EQ(files_->read(path, 2, 0).value(), "");
  EXPECT_THROW((void)files_->read(path, -1, 1), std::invalid_argument);
  EXPECT_THROW((void)files_->read(path, 0, -1), std::invalid_argument);
  expect_failure(files_->read(folder_ / "nowhere", 0, 1), "nowhere");
}

TEST_P(FileSystemContract, TakesMegabytesAtOnce) {
  std::string bytes(3'000'001, 'x');
  bytes.front() = 'a';
  bytes.back() = 'z';
  write("large", bytes);
  EXPECT_EQ(contents("large"), bytes);
}

TEST_P(FileSystemContract, CreatesNewFilesOnly) {
  write("log", "kept");
  expect_failure(files_->create(folder_ / "log"), "log");
  EXPECT_EQ(contents("log"), "kept");
  expect_failure(files_->create(folder_ / "nowhere" / "log"), "nowhere");
}

TEST_P(FileSystemContract, RenamesOverAnotherFile) {
  write("new", "new");
  write("current", "old");
  ASSERT_TRUE(files_->rename(folder_ / "new", folder_ / "current"));
  EXPECT_EQ(contents("current"), "new");
  EXPECT_THAT(files_->list(folder_).value(), ElementsAre("current"));
  expect_failure(files_->rename(folder_ / "new", folder_ / "current"), "new");
  EXPECT_EQ(contents("current"), "new");
  EXPECT_THROW((void)files_->rename(folder_ / "current", folder_ / "x" / "current"), std::invalid_argument);
}

TEST_P(FileSystemContract, AnOpenFileFollowsItsRename) {
  const auto file = files_->create(folder_ / "a").value();
  ASSERT_TRUE(file->append("1"));
  ASSERT_TRUE(files_->rename(folder_ / "a", folder_ / "b"));
  ASSERT_TRUE(file->append("2"));
  EXPECT_EQ(contents("b"), "12");
}

TEST_P(FileSystemContract, Removes) {
  write("log", "x");
  ASSERT_TRUE(files_->remove(folder_ / "log"));
  EXPECT_THAT(files_->list(folder_).value(), IsEmpty());
  expect_failure(files_->remove(folder_ / "log"), "log");
  write("log", "again");
  EXPECT_EQ(contents("log"), "again");
}

TEST_P(FileSystemContract, ListsNamesInOrder) {
  for (const char* name : {"b", "a", "c"}) write(name, "");
  EXPECT_THAT(files_->list(folder_).value(), ElementsAre("a", "b", "c"));
  expect_failure(files_->list(folder_ / "nowhere"), "nowhere");
}

TEST_P(FileSystemContract, SyncsItsFolder) {
  EXPECT_TRUE(files_->sync_folder(folder_).ok());
  expect_failure(files_->sync_folder(folder_ / "nowhere"), "nowhere");
}

TEST_P(FileSystemContract, ServesManyThreads) {
  std::vector<std::thread> threads;
  threads.reserve(4);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const std::string name = "log" + std::to_string(t);
      const auto file = files_->create(folder_ / name).value();
      for (int i = 0; i < 50; ++i) {
        EXPECT_TRUE(file->append(std::to_string(t)));
        EXPECT_TRUE(files_->list(folder_).ok());
      }
      EXPECT_EQ(contents(name.c_str()), std::string(50, static_cast<char>('0' + t)));
    });
  }
  for (std::thread& thread : threads) thread.join();
}

INSTANTIATE_TEST_SUITE_P(All, FileSystemContract,
                         testing::Values(Implementation{"Posix", [](const fs::path&) { return posix_file_system(); }},
                                         Implementation{"Faulty",
                                                        [](const fs::path& folder) {
                                                          return std::make_unique<FaultyFileSystem>(folder);
                                                        }}),
                         [](const auto& param) { return std::string(param.param.name); });

class PosixFiles : public silpose::FolderTest {};

// For its lifetime no file grows beyond so many bytes; the write that crosses the limit is short, the next one fails.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limited = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_ = {};
  void (*signal_)(int);
};

TEST_F(PosixFiles, AFailedAppendFailsTheFile) {
  const std::unique_ptr<FileSystem> files = posix_file_system();
  const fs::path path = folder_ / "log";
  const auto file = files->create(path).value();
  {
    const FileSizeLimit limit(100);
    ASSERT_TRUE(file->append(std::string(60, 'a')));
    const Result<void> full = file->append(std::string(60, 'b'));
    ASSERT_FALSE(full.ok());
    EXPECT_THAT(full.error().message, HasSubstr(path.string() + ": File too large"));
  }
  EXPECT_EQ(files->read(path, 0, kAll).value(), std::string(60, 'a') + std::string(40, 'b'));
  EXPECT_FALSE(file->append("c").ok());
  EXPECT_FALSE(file->sync().ok());
}

TEST_F(PosixFiles, ListsNoFolders) {
  fs::create_directories(folder_ / "inner");
  EXPECT_THAT(posix_file_system()->list(folder_).value(), IsEmpty());
}

}  // namespace
}  // namespace sadb
