// The cost of computing pixel-count distances of poses, against triangles, window size and particles, and its bounds.
// Threads: one at a time.
#pragma once

#include <filesystem>

namespace silpose::bench {

// Writes triangles.csv, window.csv, particles.csv and README.md, which interprets them, into a folder that is made
// where it is missing; medians of `rounds` rounds, in each of which every point is measured once.
// Errors: throws std::runtime_error for a wrong result, a missing body, or a file that cannot be written.
void write_curves(const std::filesystem::path& folder, int rounds);

}  // namespace silpose::bench
