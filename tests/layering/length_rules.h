// How long functions and files may be. Each function returns one line per violation; none: the tree obeys.
// Threads: functions without state.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace silpose {

struct LengthLimits {
  size_t function = 60, file = 450;  // lines
};

// Functions and files that are longer, in .h and .cc files under these folders of ROOT: "src/silpose/track/a.cc:12: 75
// lines of 'void f(int x) {', at most 60". A function is counted from its head to its closing brace; a lambda in a
// function is part of it. The text must be formatted (scripts/format): a closing brace stands below the beginning of
// the statement it ends.
std::vector<std::string> length_violations(const std::filesystem::path& root, const std::vector<std::string>& folders,
                                           const LengthLimits& limits = {});

}  // namespace silpose
