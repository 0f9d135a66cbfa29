// Whole text files: read at once; written under a temporary name next to the final one, then renamed, so that a reader
// never sees half a file.
// Threads: functions without state; two writers of one path are the caller's business.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "silpose/base/result.h"

namespace silpose {

// Errors: no such file, a directory, not readable; names the file.
Result<std::string> read_text_file(const std::filesystem::path& path);

// Errors: not writable, disk full; names the file. The earlier file, where there was one, is then untouched.
Result<void> write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace silpose
