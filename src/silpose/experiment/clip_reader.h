// ClipReader: recorded videos as a segmenter's observations. Segmenting takes longer than tracking and does not depend
// on the tracker's options, so each video is segmented once and kept; those used least recently are dropped where they
// are more than `keep_bytes`. What is read does not depend on what was kept: each video is segmented from its first
// frame on by itself, without a tracker that predicts where the subject is.
// Threads: one thread; segmenters work on all cores themselves.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/image/observation.h"
#include "silpose/offline/clip_instant.h"

namespace silpose {

struct ClipInput {
  std::vector<std::string> videos;       // [C] in step
  std::string segmenter = "learned";     // segment/make_segmenter.h: learned, background or masks
  std::vector<std::string> backgrounds;  // [C], or empty: auto
  int num_frames = 0;                    // the first ones; 0: all
};

class ClipReader {
 public:
  // `networks`: the folder of what scripts/fetch-network-data fetches.
  explicit ClipReader(std::string networks, size_t keep_bytes = size_t{2} << 30)
      : networks_(std::move(networks)), keep_bytes_(keep_bytes) {}

  // One observation per video and instant; frames and times are those of the videos together. `go_on` is asked after
  // each frame; when it says false there is no result. Errors: those of open_video(), make_segmenter() and the
  // segmenter; a video without a frame.
  Result<std::optional<std::vector<ClipInstant>>> read(const ClipInput& input, const std::function<bool()>& go_on);

  [[nodiscard]] size_t kept_bytes() const;  // of masks and confidence images that are kept
  [[nodiscard]] int64_t num_segmented() const { return num_segmented_; }  // frames, all calls together

 private:
  // The first frames of one video.
  struct Segmented {
    std::string key;
    std::vector<int64_t> indices, times_ns;  // [T]
    std::vector<Observation> seen;           // [T]
    bool is_whole = false;
    size_t bytes = 0;
  };
  // Which frames of the videos belong together.
  struct Step {
    int64_t frame_idx = 0, time_ns = 0;
    std::vector<int64_t> own;  // [C] each video's own index
  };
  // Null where `go_on` said false. Good until the next call of it.
  Result<const Segmented*> segment(const ClipInput& input, size_t camera,
                                   const std::function<bool(const Segmented&)>& is_enough,
                                   const std::function<bool()>& go_on);
  void drop_old();

  std::string networks_;
  size_t keep_bytes_;
  std::list<Segmented> kept_;  // the most recently used first
  int64_t num_segmented_ = 0;
};

}  // namespace silpose
