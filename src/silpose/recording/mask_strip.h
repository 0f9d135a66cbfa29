// MaskStrip: a few small images of a clip with the mask's outline on them, evenly over the clip however long it is.
// Images are cropped around the mask, to show whether its edge, hands and feet are right.
// Threads: one thread per strip.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

struct MaskExample {
  int64_t frame_idx = 0;
  double time_s = 0;
  int width = 0, height = 0;  // pixels
  bool is_empty = false;      // nothing was found; the image is whole
  std::string jpeg;           // the bytes of the file

  static auto members(auto& e) { return std::tie(e.frame_idx, e.time_s, e.width, e.height, e.is_empty, e.jpeg); }
};

class MaskStrip {
 public:
  static constexpr size_t kMost = 8;        // examples
  static constexpr int kLongestSide = 240;  // pixels of an example

  // The next image of the clip, B, G, R, and its mask. REQUIRES: equal sizes.
  void add(int64_t frame_idx, double time_s, const ByteImage& image, const Mask& mask);

  // At most kMost, the first image among them; all where there were no more.
  [[nodiscard]] std::vector<MaskExample> examples() const;

  static auto members(auto& s) { return std::tie(s.kept_, s.num_seen_, s.stride_); }

 private:
  std::vector<MaskExample> kept_;  // every stride_-th image, less than 4 kMost of them
  int64_t num_seen_ = 0, stride_ = 1;
};

}  // namespace silpose
