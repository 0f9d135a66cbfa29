// ObservationSource: from the videos and the options of a command to one observation per camera and instant.
// The next frame of a recording is read, and its segmentation is begun, while the last one is tracked.
// Threads: the main thread only; segmentation itself uses all cores.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/silpose/camera_choice.h"
#include "apps/silpose/console.h"
#include "silpose/base/job_line.h"
#include "silpose/base/result.h"
#include "silpose/image/observation.h"
#include "silpose/segment/segmenter.h"
#include "silpose/video/video.h"

namespace silpose::app {

struct InputOptions {
  std::vector<std::string> videos;
  std::string segmenter = "auto";
  std::vector<std::string> masks, backgrounds, regions, garbage_masks;  // one for all, or one per camera
  std::string key_colour = "auto", depth_range;
  std::vector<std::string> depths;  // one per camera
  int grow_px = 0;
  std::optional<int> min_blob_px;     // absent: the segmenter's own
  std::optional<double> default_fps;  // 30 and a warning where it is needed and not given
  [[nodiscard]] VideoOptions video_options() const { return {.default_fps = default_fps.value_or(30)}; }
  std::optional<double> start_s, end_s;
};

void add_input_options(CLI::App& command, InputOptions& options);

// Everything of one instant.
struct Instant {
  Frame frame;
  std::vector<Observation> observations;  // [C]
  double decode_s = 0, segment_s = 0;
};

// Not to be moved once next() was called: what it reads ahead refers to it.
class ObservationSource {
 public:
  // Opens the videos. Errors: those of open_video(). Throws UsageError for options that do not fit together.
  static Result<ObservationSource> open(const InputOptions& options);

  // Makes the segmenters, which learn what they have to learn. Errors: those of make_segmenter(); a garbage mask of
  // another size. Throws UsageError for an option whose text or number of values does not fit. REQUIRES: called once,
  // before the first next().
  Result<void> learn(Console& console);

  // From here on about `count` instants are given, evenly over the clip; the others are not segmented.
  void thin_out_to(int64_t count);

  // Where the subject is expected in the next pictures: [C], or empty where unknown.
  void expect(std::vector<Mask> silhouettes);

  // The next instant to be tracked, nothing at the end. Errors: those of the video and of the segmenter.
  Result<std::optional<Instant>> next();
  // The same, without masks: only segmenters that must see every picture are shown it.
  Result<std::optional<Frame>> skip();

  // Back to the first instant, as if none had been given. What was learned is kept, unless a segmenter cannot go back.
  // Errors: as learn().
  Result<void> rewind(Console& console);

  // What next() carries from call to call. Another source with the same options that skipped as many instants continues
  // from it as this one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] std::string state() const;
  void restore(std::string_view state);

  // The videos from their first frame on, for a pass of their own. REQUIRES: no next() afterwards.
  Result<Video*> videos_again();

  [[nodiscard]] const Video& video() const { return *video_; }
  [[nodiscard]] std::vector<PictureSize> sizes() const;
  // How many instants next() will give, where that is known; 0 otherwise.
  [[nodiscard]] int64_t num_expected() const;
  [[nodiscard]] std::string background() const;  // "background auto", "masks", ... of each camera
  [[nodiscard]] bool finds_keypoints() const;    // of any camera
  // Observation::ignored of a camera.
  [[nodiscard]] std::shared_ptr<const Mask> ignored(size_t camera) const { return segmenters_[camera]->ignored(); }
  [[nodiscard]] std::vector<std::string> warnings() const;         // whole only after the last next()
  [[nodiscard]] double learning_s() const { return learning_s_; }  // time spent before the first instant

 private:
  ObservationSource() = default;
  Result<std::optional<Instant>> read(bool segments);

  // A frame of the video, and how long it took to read and to prepare.
  struct Read {
    Result<std::optional<Frame>> frame = std::optional<Frame>();
    double decode_s = 0, prepare_s = 0;
  };
  Result<Read> read_frame();
  void read_ahead();
  [[nodiscard]] bool may_be_tracked(const Frame& frame) const;

  InputOptions options_;
  std::unique_ptr<Video> video_;
  std::vector<std::unique_ptr<Segmenter>> segmenters_;
  std::vector<std::string> warnings_;
  std::optional<std::vector<std::string>> video_warnings_;  // of the pass before videos_again()
  std::string first_state_;
  int64_t stride_ = 1, num_wanted_ = 0;
  int64_t num_seen_ = 0, num_cut_ = 0;  // masks with a subject, and of these at the edge of the picture
  double learning_s_ = 0;
  int64_t start_ns_ = 0, end_ns_ = 0;                             // of the stretch that --start and --end choose
  std::unique_ptr<Read> next_;                                    // read ahead, where a job of `ahead_` was given
  std::unique_ptr<JobLine> ahead_ = std::make_unique<JobLine>();  // last: its jobs use the rest
};

}  // namespace silpose::app
