// ImageList: the image files that a folder, a printf pattern or a single name denotes, and their numbers.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

struct ImageList {
  std::vector<std::filesystem::path> paths;  // in the order of their numbers, or of their names where not all have one
  std::vector<int64_t> numbers = {};         // one per path, ascending; or none: counted from 0
};

// By its extension.
bool is_image_name(const std::filesystem::path& path);

// open_video() documents which names have numbers. Errors: missing, no image in it, a number that is there twice, a
// gap in a pattern's numbers.
Result<ImageList> list_images(const std::string& input);

}  // namespace silpose
