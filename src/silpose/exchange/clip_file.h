// Recorded motion from a file of any known kind, chosen by its extension: .bvh, and .txt (humanoid3d).
// Threads: functions without state.
#pragma once

#include <filesystem>

#include "silpose/base/result.h"
#include "silpose/mocap/clip.h"

namespace silpose {

// Whether read_clip() knows files of that name.
bool is_clip_file(const std::filesystem::path& path);

// Errors: an unknown kind of file; those of read_bvh() and read_humanoid3d().
Result<Clip> read_clip(const std::filesystem::path& path);

}  // namespace silpose
