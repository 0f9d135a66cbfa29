#include "silpose/session/observation_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"

namespace silpose {

ObservationSource::ObservationSource(Video video, SourceOptions options, ProgressSink* progress)
    : options_(std::move(options)), video_(std::move(video)), progress_(progress) {
  const auto num_cameras = static_cast<size_t>(video_.num_cameras());
  if (options_.segmenters.size() == 1) options_.segmenters.resize(num_cameras, options_.segmenters[0]);
  check(options_.segmenters.size() == num_cameras, "ObservationSource: {} segmenters for {} cameras",
        options_.segmenters.size(), num_cameras);
  // A quarter of a frame's time makes up for rounded time stamps.
  const double margin_s = 0.25 / video_.fps();
  start_ns_ = std::llround((options_.start_s.value_or(0) - margin_s) * 1e9);
  end_ns_ = options_.end_s ? std::llround((*options_.end_s + margin_s) * 1e9) : std::numeric_limits<int64_t>::max();
}

Result<std::unique_ptr<ObservationSource>> ObservationSource::open(Video video, SourceOptions options,
                                                                   ProgressSink* progress) {
  std::unique_ptr<ObservationSource> source(new ObservationSource(std::move(video), std::move(options), progress));
  if (Result<void> learned = source->learn(); !learned) return learned.failure();
  return source;
}

Result<void> ObservationSource::learn() {
  const Stopwatch learning;
  segmenters_.clear();
  for (size_t camera = 0; camera < options_.segmenters.size(); ++camera) {
    Video alone = video_.alone(static_cast<int>(camera));
    Result<std::unique_ptr<Segmenter>> made = make_segmenter(alone, options_.segmenters[camera], progress_);
    if (!made) return made.failure();
    segmenters_.push_back(std::move(*made));
  }
  if (Result<void> rewound = video_.rewind(); !rewound) return rewound;
  learning_s_ += learning.seconds();
  num_seen_ = num_cut_ = 0;
  first_state_ = state();
  return {};
}

Result<void> ObservationSource::rewind() {
  if (Result<void> done = ahead_.finish(); !done) return done;
  next_.reset();
  stride_ = 1;
  num_wanted_ = 0;
  if (!std::ranges::all_of(segmenters_, [](const auto& segmenter) { return segmenter->can_go_back(); })) {
    return learn();
  }
  restore(first_state_);
  return video_.rewind();
}

Result<Video*> ObservationSource::rewound_video() {
  if (Result<void> done = ahead_.finish(); !done) return done.failure();
  next_.reset();
  video_warnings_ = video_.warnings();  // a shorter pass would not find them all again
  if (Result<void> rewound = video_.rewind(); !rewound) return rewound.failure();
  return &video_;
}

void ObservationSource::expect(std::vector<Mask> silhouettes) {
  for (size_t camera = 0; camera < silhouettes.size(); ++camera) {
    segmenters_[camera]->expect(std::move(silhouettes[camera]));
  }
}

Result<std::optional<Instant>> ObservationSource::next() { return read(true); }

Result<std::optional<Frame>> ObservationSource::skip() {
  Result<std::optional<Instant>> instant = read(false);
  if (!instant) return instant.failure();
  if (!instant->has_value()) return std::optional<Frame>();
  return std::optional<Frame>(std::move((*instant)->frame));
}

std::string ObservationSource::state() const {
  std::vector<std::string> of_segmenters;
  for (const auto& segmenter : segmenters_) of_segmenters.push_back(segmenter->state());
  return to_bytes(of_segmenters, num_seen_, num_cut_);
}

void ObservationSource::restore(std::string_view state) {
  std::vector<std::string> of_segmenters;
  check(from_bytes(state, of_segmenters, num_seen_, num_cut_) && of_segmenters.size() == segmenters_.size(),
        "ObservationSource: not a state of it");
  for (size_t camera = 0; camera < segmenters_.size(); ++camera) segmenters_[camera]->restore(of_segmenters[camera]);
}

void ObservationSource::thin_out_to(int64_t count) {
  constexpr int64_t kUnknownLength = 4;
  stride_ = num_expected() > 0 ? (num_expected() + count - 1) / count : kUnknownLength;
}

bool ObservationSource::may_be_tracked(const Frame& frame) const {
  if (frame.time_ns < start_ns_ || frame.time_ns > end_ns_) return false;
  for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
    if (video_.own_index(static_cast<int>(camera)) < segmenters_[camera]->first_index()) return false;
  }
  return true;
}

void ObservationSource::read_ahead() {
  next_ = std::make_unique<Read>();
  Result<void> given = ahead_.submit([this, to = next_.get()]() -> Result<void> {
    Stopwatch stopwatch;
    to->frame = video_.next();
    to->decode_s = stopwatch.restart();
    if (!to->frame || !to->frame->has_value() || stride_ > 1 || !may_be_tracked(**to->frame)) return {};
    for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
      segmenters_[camera]->prepare((*to->frame)->images[camera], video_.own_index(static_cast<int>(camera)));
    }
    to->prepare_s = stopwatch.seconds();
    return {};
  });
  check(given.ok(), "ObservationSource: its jobs report their failures elsewhere");
}

Result<ObservationSource::Read> ObservationSource::read_frame() {
  if (!next_) {
    const Stopwatch stopwatch;
    Read read{.frame = video_.next()};
    read.decode_s = stopwatch.seconds();
    return read;
  }
  if (Result<void> done = ahead_.finish(); !done) return done.failure();
  return std::move(*std::exchange(next_, nullptr));
}

Result<void> ObservationSource::observe(Instant& instant, bool is_wanted) {
  for (size_t camera = 0; camera < segmenters_.size(); ++camera) {
    if (!is_wanted && !segmenters_[camera]->sees_all()) continue;
    const Stopwatch segmenting;
    Result<Observation> seen =
        segmenters_[camera]->segment(instant.frame.images[camera], video_.own_index(static_cast<int>(camera)));
    instant.segment_s += segmenting.seconds();
    if (!seen) return seen.failure();
    seen->time_ns = instant.frame.time_ns;
    if (is_wanted) instant.observations.push_back(std::move(*seen));
  }
  return {};
}

Result<std::optional<Instant>> ObservationSource::read(bool segments) {
  Instant instant;
  for (int64_t num_skipped = 0;; ++num_skipped) {
    Result<Read> read = read_frame();
    if (!read) return read.failure();
    Result<std::optional<Frame>>& frame = read->frame;
    if (!frame) return frame.failure();
    if (!frame->has_value() || (*frame)->time_ns > end_ns_) return std::optional<Instant>();
    instant.decode_s += read->decode_s;
    instant.segment_s += read->prepare_s;
    instant.frame = std::move(**frame);
    const bool is_before = !may_be_tracked(instant.frame);
    const bool is_wanted = !is_before && num_wanted_++ % stride_ == 0;
    if (Result<void> observed = observe(instant, is_wanted && segments); !observed) return observed.failure();
    if (!is_wanted) {
      const bool goes_on = !is_before || !progress_ || progress_->update("skipping to the start", num_skipped, 0);
      if (!goes_on) return std::optional<Instant>();
      continue;
    }
    for (const Observation& seen : instant.observations) {  // restore() sets it where they are skipped
      num_seen_ += seen.trust.nothing_found ? 0 : 1;
      num_cut_ += seen.trust.touches_border ? 1 : 0;
    }
    if (segments && !video_.is_live()) read_ahead();  // a live image should be the newest one
    return std::optional<Instant>(std::move(instant));
  }
}

int64_t ObservationSource::num_expected() const {
  if (video_.num_frames_hint() <= 0) return 0;
  // As if the rate were constant.
  const auto frame_at = [&](int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9 * video_.fps(); };
  const int64_t before = video_.first_index();
  const auto end = std::min(static_cast<double>(before + video_.num_frames_hint() - 1), frame_at(end_ns_)) + 1;
  auto first = std::max(static_cast<double>(before), std::ceil(frame_at(start_ns_)));
  for (const auto& segmenter : segmenters_) first = std::max(first, static_cast<double>(segmenter->first_index()));
  return std::max<int64_t>(0, static_cast<int64_t>(end - first));
}

std::string ObservationSource::segmentation() const {
  std::string names;
  for (const auto& segmenter : segmenters_) {
    if (names.find(segmenter->name()) == std::string::npos) names += (names.empty() ? "" : ", ") + segmenter->name();
  }
  return names;
}

bool ObservationSource::finds_keypoints() const {
  return std::ranges::any_of(segmenters_, [](const auto& segmenter) { return segmenter->finds_keypoints(); });
}

std::vector<std::string> ObservationSource::warnings() const {
  (void)ahead_.finish();  // next() reports its failure
  std::vector<std::string> all;
  for (const auto& segmenter : segmenters_) {
    const std::vector<std::string> own = segmenter->warnings();
    all.insert(all.end(), own.begin(), own.end());
  }
  if (2 * num_cut_ > num_seen_) {
    all.push_back(
        fmt::format("{}: the subject reaches the edge of the image in {:.0f} % of the masks; a whole body is "
                    "assumed, and what lies outside is guessed",
                    video_.name(), 100.0 * static_cast<double>(num_cut_) / static_cast<double>(num_seen_)));
  }
  const std::vector<std::string> of_video = video_warnings_ ? *video_warnings_ : video_.warnings();
  all.insert(all.end(), of_video.begin(), of_video.end());
  return all;
}

}  // namespace silpose
