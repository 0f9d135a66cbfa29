// The segmenters that only pass masks on: masks from files, one per image, or images that are masks. Made by
// make_segmenter().
// Threads: one thread per segmenter.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/segment/clean_up.h"
#include "silpose/segment/segmenter.h"
#include "silpose/video/video.h"

namespace silpose {

// Mask number i belongs to image number i + offset; without `masks` every image is its own mask. White (>= 128) is
// set. `name`: of what holds the masks.
std::unique_ptr<Segmenter> make_given_masks(std::string name, std::optional<Video> masks, int64_t offset,
                                            const CleanUpOptions& clean_up, std::vector<std::string> warnings = {});

// Whether a video's images are masks: black and white alone, judged by the first ones that are not all black.
// Errors: those of Video::next().
Result<bool> shows_masks(Video& video);

}  // namespace silpose
