// The segmenters that find nothing themselves: masks from files, one a picture, or pictures that are masks. Made by
// make_segmenter().
// Threads: one thread per segmenter.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "silpose/image/video.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// Mask number i belongs to picture number i + offset; without `masks` every picture is its own mask. White (>= 128) is
// set.
std::unique_ptr<Segmenter> make_given_masks(std::optional<Video> masks, int64_t offset, const CleanUpOptions& clean_up);

}  // namespace silpose
