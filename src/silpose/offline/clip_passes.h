// ClipPasses: the passes of an online tracker over a clip that smoothing starts from: from the clearest instant to the
// end, back to the beginning, and once more to the end. One pass may find what another missed.
// Threads: one thread; a step uses all cores and gives the same result on any number.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/offline/clip_hypotheses.h"
#include "silpose/offline/judged_clip.h"
#include "silpose/track/tracker.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// `options` for a pass over a clip that only has to find the basin: online, and on a mesh no finer than that requires.
TrackerOptions options_of_pass(const TrackerOptions& options);

class ClipPasses {
 public:
  static constexpr size_t kNumPasses = 3;

  // Over the instants `first` to `last`, the first and the last that are seen. The clip must
  // outlive this.
  ClipPasses(const TrackerOptions& options, const JudgedClip& clip, size_t first, size_t last);

  // Where the first pass begins, and how long it took to find it.
  void start_at(size_t instant, double seconds);
  [[nodiscard]] double start_seconds() const { return start_seconds_; }

  // Takes all passes, from where it was stopped or restored. `proceed` is asked after each instant, with the share of
  // the whole work, smoothing included, that is done; where it returns false, this does, too. Otherwise `keep` is
  // called. REQUIRES: start_at() or restore() before.
  bool run(const std::function<bool(double share)>& proceed, const std::function<void()>& keep);

  [[nodiscard]] double share_done() const { return done_; }
  [[nodiscard]] std::span<const Hypotheses> hypotheses() const { return hypotheses_; }  // [T] of the clip
  [[nodiscard]] const std::vector<double>& noise() const { return noise_; }  // [C] of the outlines, or empty; last pass

  // State from which another object of the same options and clip continues exactly as this one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] std::string state() const;
  void restore(std::string_view state);

 private:
  bool pass(size_t from, size_t to, const std::function<bool(double share)>& proceed,
            const std::function<void()>& keep);
  void begin_pass();
  void step(size_t t, int64_t time_ns, double direction);

  TrackerOptions options_;
  const JudgedClip& clip_;
  size_t first_, last_;
  size_t start_ = 0, pass_ = 0, step_ = 0;  // where the first pass begins; the pass under way, and its steps so far
  std::vector<double> last_pose_, noise_;
  std::vector<Hypotheses> hypotheses_;  // [T]
  double done_ = 0, start_seconds_ = 0;
  std::optional<Tracker> tracker_;  // of the pass under way
  std::string resumed_tracker_;     // its state when an earlier call was stopped
};

}  // namespace silpose
