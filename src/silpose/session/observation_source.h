// ObservationSource: from the frames of one or several cameras to one observation per camera and instant.
// The next frame of a recording is read, and its segmentation is begun, while the last one is tracked.
// Threads: one thread per source; segmentation itself uses all cores.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/base/serial_queue.h"
#include "silpose/image/frame.h"
#include "silpose/image/observation.h"
#include "silpose/segment/make_segmenter.h"
#include "silpose/segment/segmenter.h"
#include "silpose/video/video.h"

namespace silpose {

struct SourceOptions {
  std::vector<SegmenterOptions> segmenters = {{}};  // one for all cameras, or one per camera
  // Seconds of the frames' own times, both included; absent: the whole clip.
  std::optional<double> start_s, end_s;
};

// Everything of one instant.
struct Instant {
  Frame frame;
  std::vector<Observation> observations;  // [C]
  double decode_s = 0, segment_s = 0;
};

class ObservationSource {
 public:
  // Makes the segmenters, which learn what they have to learn from the video, and rewinds it. `progress` may be null;
  // otherwise it must outlive the source.
  // Errors: those of make_segmenter(). Throws std::invalid_argument for another number of segmenters.
  static Result<std::unique_ptr<ObservationSource>> open(Video video, SourceOptions options = {},
                                                         ProgressSink* progress = nullptr);
  ObservationSource(const ObservationSource&) = delete;
  ObservationSource& operator=(const ObservationSource&) = delete;

  // From here on about `count` instants are given, evenly over the clip; the others are not segmented.
  void thin_out_to(int64_t count);

  // Where the subject is expected in the next images: [C], or empty where unknown.
  void expect(std::vector<Mask> silhouettes);

  // The next instant to be tracked; nullopt at the end, or where the progress sink asks to stop.
  // Errors: those of the video and of the segmenter.
  Result<std::optional<Instant>> next();
  // The same, without observations: only segmenters that must see every image are shown it.
  Result<std::optional<Frame>> skip();

  // Back to the first instant, as if none had been given. What was learned is kept, unless a segmenter cannot go back.
  // Errors: as open().
  Result<void> rewind();

  // What next() carries from call to call. Another source with the same options that skipped as many instants continues
  // from it as this one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] std::string state() const;
  void restore(std::string_view state);

  // The video from its first frame on, for a pass of its own. REQUIRES: no next() afterwards.
  Result<Video*> rewound_video();

  [[nodiscard]] const Video& video() const { return video_; }
  // How many instants next() will give, where that is known; 0 otherwise.
  [[nodiscard]] int64_t num_expected() const;
  [[nodiscard]] std::string segmentation() const;  // "background auto", "masks", ... of each camera
  [[nodiscard]] bool finds_keypoints() const;      // of any camera
  // Observation::ignored of a camera.
  [[nodiscard]] std::shared_ptr<const Mask> ignored(size_t camera) const { return segmenters_[camera]->ignored(); }
  [[nodiscard]] std::vector<std::string> warnings() const;         // complete only after the last next()
  [[nodiscard]] double learning_s() const { return learning_s_; }  // time spent before the first instant

 private:
  ObservationSource(Video video, SourceOptions options, ProgressSink* progress);
  Result<void> learn();
  Result<std::optional<Instant>> read(bool segments);
  Result<void> observe(Instant& instant, bool is_wanted);

  // A frame of the video, and how long it took to read and to prepare.
  struct Read {
    Result<std::optional<Frame>> frame = std::optional<Frame>();
    double decode_s = 0, prepare_s = 0;
  };
  Result<Read> read_frame();
  void read_ahead();
  [[nodiscard]] bool may_be_tracked(const Frame& frame) const;

  SourceOptions options_;
  Video video_;
  ProgressSink* progress_;
  std::vector<std::unique_ptr<Segmenter>> segmenters_;
  std::optional<std::vector<std::string>> video_warnings_;  // of the pass before rewound_video()
  std::string first_state_;
  int64_t stride_ = 1, num_wanted_ = 0;
  int64_t num_seen_ = 0, num_cut_ = 0;  // masks with a subject, and of these at the edge of the image
  double learning_s_ = 0;
  int64_t start_ns_ = 0, end_ns_ = 0;  // of the stretch that the options choose
  std::unique_ptr<Read> next_;         // read ahead, where a job of `ahead_` was given
  mutable SerialQueue ahead_;          // last: its jobs use the rest
};

}  // namespace silpose
