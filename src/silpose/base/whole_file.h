// write_whole(): a file that is either whole or not there. Threads: a function without state.
#pragma once

#include <filesystem>
#include <functional>

#include "silpose/base/result.h"

namespace silpose {

// Writes a single file next to its final name, then renames it: `write` gets the temporary path, which ends in the same
// extension. Makes the folder. Errors: those of `write`; a directory of that name; not writable.
Result<void> write_whole(const std::filesystem::path& file,
                         const std::function<Result<void>(const std::filesystem::path&)>& write);

}  // namespace silpose
