// The segmenters that learn a background: from a model made beforehand, or image by image. Made by
// make_segmenter(). Threads: one thread per segmenter.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/segment/background_model.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/depth_files.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// Depth that is used together with the colours.
struct JoinedDepth {
  DepthFiles files;
  DepthImage background;  // learn_depth_background()
};

struct BackgroundSegmenterOptions {
  std::string name;                   // see Segmenter::name()
  int64_t first_index = 0;            // see Segmenter::first_index()
  std::vector<std::string> warnings;  // known from the start
  CleanUpOptions clean_up;
  std::optional<JoinedDepth> depth;  // of a learned background; not of an online one
};

std::unique_ptr<Segmenter> make_background_segmenter(BackgroundModel model, BackgroundSegmenterOptions options);

enum class OnlineMixture { kMog2, kKnn };

// Mixtures of Gaussians or nearest neighbours per pixel that keep learning; shadows count as background. Has no model
// in its first images: trust is 0 there.
std::unique_ptr<Segmenter> make_online_segmenter(OnlineMixture mixture, BackgroundSegmenterOptions options);

}  // namespace silpose
