#include "silpose/base/data_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "silpose/base/folder_for_test.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

class DataFolder : public FolderTest {
 protected:
  DataFolder() {
    if (const char* set = std::getenv("SILPOSE_DATA")) before_ = set;
  }
  ~DataFolder() override { set(before_); }

  static void set(const std::string& folder) {
    if (folder.empty()) {
      unsetenv("SILPOSE_DATA");
    } else {
      setenv("SILPOSE_DATA", folder.c_str(), 1);
    }
  }

 private:
  std::string before_;
};

TEST_F(DataFolder, IsThatOfTheEnvironmentWhetherItIsThereOrNot) {
  set((folder_ / "absent").string());
  EXPECT_EQ(data_directory(), folder_ / "absent");
}

TEST_F(DataFolder, IsThatOfTheBuildForAProgramThatIsNotInstalled) {
  set("");
  EXPECT_EQ(data_directory(), fs::path(SILPOSE_DATA_DIR));
}

TEST_F(DataFolder, ExperimentsAreThoseOfTheDataWhereItHasAny) {
  set(folder_.string());
  EXPECT_TRUE(fs::exists(experiments_directory() / "human-walk.toml")) << "those of the source tree";
  fs::create_directories(folder_ / "experiments");
  EXPECT_EQ(experiments_directory(), folder_ / "experiments");
}

}  // namespace
}  // namespace silpose
