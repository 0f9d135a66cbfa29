// SegmentationOptions: how the subject is cut out of the images, as a user says it for all cameras of a clip; and what
// that means for the segmenter of each.
// Threads: values and functions without state; the table is constant.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/base/result.h"
#include "silpose/segment/make_segmenter.h"
#include "silpose/video/video.h"

namespace silpose {

// Lists hold one value for all cameras, or one per camera; those of files of frames (masks, depth) one per camera.
struct SegmentationOptions {
  std::string segmenter = "auto";                      // SegmenterOptions::kind
  std::vector<std::string> backgrounds;                // segment/background_origin.h
  std::string key_colour = "auto";                     // segment/key_colour.h
  std::vector<std::string> depths;                     // SegmenterOptions::depth
  std::optional<std::array<double, 2>> depth_range_m;  // nearest, farthest
  std::vector<std::string> masks;                      // SegmenterOptions::masks
  std::vector<std::string> regions;                    // "x,y,w,h", whole pixels
  std::vector<std::string> garbage_masks;              // image files
  int grow_px = 0;                                     // negative shrinks
  std::optional<int> min_blob_px;                      // absent: the segmenter's own

  // Errors: throws OptionError for an option that needs another segmenter, and for values that cannot be understood.
  void check() const;
};

const OptionTable<SegmentationOptions>& segmentation_option_table();

// The options of each camera's segmenter, [C]. `networks`: SegmenterOptions::networks.
// Errors: a garbage mask that cannot be read or has another size than the video. Throws OptionError as check(), and for
// a list that has neither one value nor one per camera.
Result<std::vector<SegmenterOptions>> segmenter_options(const SegmentationOptions& options, const Video& video,
                                                        const std::filesystem::path& networks);

}  // namespace silpose
