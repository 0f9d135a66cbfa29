// BackgroundModel: what a static camera sees behind the subject, and how much it varies by itself: per pixel and
// channel a median and a noise scale. Channels are luma and two colour differences: video noise and shadows live in the
// luma, the colour differences are more stable.
// Based on: the temporal median with the median absolute deviation as scale (references.bib: rousseeuw1993).
// Threads: a value; the functions may be called from any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/video/video.h"

namespace silpose {

struct BackgroundModel {
  ByteImage median;    // [H, W, 3] Y, Cr, Cb
  Image<float> noise;  // [H, W, 3] standard deviation in grey levels, never below a floor

  [[nodiscard]] int width() const { return median.width(); }
  [[nodiscard]] int height() const { return median.height(); }
};

// Images spread evenly over a stretch of video, few enough to be kept in memory, as Y, Cr, Cb.
struct BackgroundSamples {
  std::vector<ByteImage> images;      // each [H, W, 3]
  std::optional<int64_t> next_index;  // of the first frame not before end_ns, where there is one
};

// Reads all frames, keeps some. Only frames less than end_ns after the first, when given.
// Errors: those of Video::next(); no frame before end_ns; stopped by the progress sink.
Result<BackgroundSamples> sample_background(Video& video, std::optional<int64_t> end_ns = {},
                                            ProgressSink* progress = nullptr);

// From samples in which every pixel shows the background more than half of the time. REQUIRES: at least one sample.
BackgroundModel learn_background(const BackgroundSamples& samples);

// From an image [H, W, 3] (B, G, R) of the empty scene; the pixels' noise comes from samples of the clip, which may
// show people (none: a default). REQUIRES: equal sizes.
BackgroundModel background_from_plate(const ByteImage& plate, const BackgroundSamples& samples = {});

// 8-bit B, G, R to Y, Cr, Cb, and back.
ByteImage to_luma_chroma(const ByteImage& image);
ByteImage from_luma_chroma(const ByteImage& image);

}  // namespace silpose
