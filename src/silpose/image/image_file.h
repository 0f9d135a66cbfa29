// Images as files (PNG, JPEG, whatever OpenCV reads).
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

// Larger images (than 8192x8192) are refused: a clip of them fills any memory.
inline constexpr uint64_t kMostPixels = uint64_t{1} << 26;

// 16-bit and transparent images come as 8-bit colour. Errors: no such file, empty, not an image, more than
// kMostPixels.
Result<ByteImage> read_colour_image(const std::filesystem::path& path);  // 3 channels B, G, R
Result<ByteImage> read_grey_image(const std::filesystem::path& path);    // 1 channel
Result<Mask> read_mask(const std::filesystem::path& path);               // white (>= 128) is set

// Errors: as above; not one channel of 16 bits; not writable.
Result<DepthImage> read_depth_image(const std::filesystem::path& path);
Result<void> write_depth_image(const std::filesystem::path& path, const DepthImage& image);

// 1 or 3 channels; the extension determines the format. Errors: not writable.
Result<void> write_image(const std::filesystem::path& path, const ByteImage& image);
Result<void> write_mask(const std::filesystem::path& path, const Mask& mask);

// The bytes of a JPEG file. REQUIRES: 1 or 3 channels, not empty. `quality` 1 to 100.
std::string jpeg_bytes(const ByteImage& image, int quality);

}  // namespace silpose
