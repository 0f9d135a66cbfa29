// SourceTree: a small tree of sources made in a test. Threads: one.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "silpose/base/folder_for_test.h"

namespace silpose {

class SourceTree : public FolderTest {
 protected:
  void write(const std::filesystem::path& file, const std::string& text) const {
    std::filesystem::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  const std::filesystem::path root_ = folder_;
};

}  // namespace silpose
