#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "sadb/files/fault_injection_for_test.h"

namespace sadb {
namespace {

using silpose::Result;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

const fs::path kFolder = "/data";

class FaultyFiles : public testing::Test {
 protected:
  FaultyFileSystem files_{kFolder};

  std::string contents(const char* name) const {
    return files_.read(kFolder / name, 0, std::numeric_limits<int64_t>::max()).value();
  }
  // A file that survives a crash.
  void establish(const char* name, std::string_view bytes) {
    const auto file = files_.create(kFolder / name).value();
    ASSERT_TRUE(file->append(bytes));
    ASSERT_TRUE(file->sync());
    ASSERT_TRUE(files_.sync_folder(kFolder));
  }
};

TEST_F(FaultyFiles, ACrashTakesUnsyncedBytes) {
  const auto file = files_.create(kFolder / "log").value();
  ASSERT_TRUE(files_.sync_folder(kFolder));
  ASSERT_TRUE(file->append("synced"));
  ASSERT_TRUE(file->sync());
  ASSERT_TRUE(file->append(" and not"));
  files_.crash();
  EXPECT_EQ(contents("log"), "synced");
  EXPECT_THAT(file->append("more").error().message, HasSubstr("/data/log: the machine crashed"));
  EXPECT_FALSE(file->sync().ok());
}

TEST_F(FaultyFiles, ACrashMayLeaveATornTail) {
  establish("log", "synced");
  const auto file = files_.create(kFolder / "second").value();
  ASSERT_TRUE(files_.sync_folder(kFolder));
  ASSERT_TRUE(file->append("abcdef"));
  files_.crash(4);
  EXPECT_EQ(contents("second"), "abcd");
  EXPECT_EQ(contents("log"), "synced");
  files_.crash();  // what survived one crash survives the next
  EXPECT_EQ(contents("second"), "abcd");
}

TEST_F(FaultyFiles, ACrashUndoesUnsyncedNames) {
  establish("kept", "1");
  establish("removed", "2");
  establish("renamed", "3");
  const auto created = files_.create(kFolder / "created").value();
  ASSERT_TRUE(created->append("4"));
  ASSERT_TRUE(created->sync());
  ASSERT_TRUE(files_.remove(kFolder / "removed"));
  ASSERT_TRUE(files_.rename(kFolder / "renamed", kFolder / "kept"));
  EXPECT_THAT(files_.list(kFolder).value(), ElementsAre("created", "kept"));
  files_.crash();
  EXPECT_THAT(files_.list(kFolder).value(), ElementsAre("kept", "removed", "renamed"));
  EXPECT_EQ(contents("kept"), "1");
  EXPECT_EQ(contents("renamed"), "3");
}

TEST_F(FaultyFiles, OneOperationFailsWithoutEffect) {
  establish("log", "x");
  files_.fail_after(1);
  EXPECT_THAT(files_.list(kFolder).value(), ElementsAre("log"));
  EXPECT_THAT(files_.remove(kFolder / "log").error().message, HasSubstr("/data/log: Input/output error"));
  EXPECT_EQ(contents("log"), "x");
  EXPECT_TRUE(files_.remove(kFolder / "log").ok());
}

TEST_F(FaultyFiles, AShortWriteLeavesHalf) {
  const auto file = files_.create(kFolder / "log").value();
  files_.fail_after(1, Fault::kShortWrite);
  ASSERT_TRUE(file->append("whole "));
  EXPECT_FALSE(file->append("half").ok());
  EXPECT_EQ(contents("log"), "whole ha");
  EXPECT_FALSE(file->append("more").ok());
  EXPECT_FALSE(file->sync().ok());
  EXPECT_EQ(contents("log"), "whole ha");
}

// Replaces "current" as a store does: a new file beside it, synced, renamed over it, the folder synced.
Result<void> replace(FileSystem& files, std::string_view bytes, bool syncs) {
  Result<std::unique_ptr<WritableFile>> file = files.create(kFolder / "next");
  if (!file) return file.failure();
  if (Result<void> good = (*file)->append(bytes); !good) return good;
  if (syncs) {
    if (Result<void> good = (*file)->sync(); !good) return good;
  }
  if (Result<void> good = files.rename(kFolder / "next", kFolder / "current"); !good) return good;
  return files.sync_folder(kFolder);
}

// What is in "current" after a replacement of "old" by "new" whose operation after `num_good` fails, and a crash.
std::string after_crash(int64_t num_good, Fault fault, bool syncs, bool* succeeded) {
  FaultyFileSystem files(kFolder);
  EXPECT_TRUE(replace(files, "old", true));
  files.fail_after(num_good, fault);
  *succeeded = replace(files, "new", syncs).ok();
  files.crash();
  return files.read(kFolder / "current", 0, 100).value();
}

TEST(FaultyFileSystem, FindsThatACarefulReplacementIsAtomic) {
  for (const Fault fault : {Fault::kNoEffect, Fault::kShortWrite}) {
    bool succeeded = false;
    int64_t num_good = 0;
    for (; !succeeded; ++num_good) {
      const std::string left = after_crash(num_good, fault, true, &succeeded);
      EXPECT_EQ(left, succeeded ? "new" : "old") << num_good;
    }
    EXPECT_EQ(num_good, 6);  // create, append, sync, rename, sync_folder; then none fails
  }
}

TEST(FaultyFileSystem, FindsThatACarelessReplacementIsNot) {
  bool succeeded = false;
  EXPECT_EQ(after_crash(100, Fault::kNoEffect, false, &succeeded), "");
  EXPECT_TRUE(succeeded);
}

TEST(FaultyFileSystem, CountsOperations) {
  FaultyFileSystem files(kFolder);
  ASSERT_TRUE(replace(files, "x", true));
  EXPECT_EQ(files.num_operations(), 5);
  EXPECT_FALSE(files.create(kFolder / "current").ok());
  EXPECT_EQ(files.num_operations(), 6);
}

}  // namespace
}  // namespace sadb
