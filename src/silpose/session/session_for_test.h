// For tests: a tube (body/test_body.h) that moves before one or two cameras, its silhouettes as black and white frames
// of a source that counts its passes and may fail. Threads: one.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "silpose/body/test_body.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/frame_source.h"
#include "silpose/render/silhouette.h"
#include "silpose/session/session.h"

namespace silpose {

// The tube upright or bent, at the places where it starts: what common poses are for a human.
class TubeStarts : public Proposal {
 public:
  Proposed propose(const ProposalContext& /*context*/, int /*count*/, Rng& /*rng*/) const override {
    StateBatch states = StateBatch::Zero(3, 8);
    states(1, 5) = 0.5;
    states(2, 5) = -0.5;
    return {states};
  }
};

inline std::vector<double> tube_pose(int64_t t) {
  const auto at = static_cast<double>(t);
  return {0.01 * at, 0.5, 0, 0, 0, 0.4 * std::sin(0.15 * at), 0, 0.3 * std::cos(0.15 * at)};
}

inline PinholeCamera tube_camera(int number) {
  const Eigen::Vector3d place = number == 0 ? Eigen::Vector3d(0, 1.2, 4.5) : Eigen::Vector3d(4.5, 1.2, 0);
  PinholeCamera camera = look_at_camera(160, 120, 150, place, {0, 0.75, 0});
  camera.name = number == 0 ? "front" : "side";
  return camera;
}

struct PassCounts {
  int images = 0;  // read, in all passes
};

class TubeSource : public FrameSource {
 public:
  struct Options {
    int camera = 0;
    int64_t num_frames = 12;
    int64_t fails_at = std::numeric_limits<int64_t>::max();  // of each pass
  };
  TubeSource(const Options& options, std::shared_ptr<PassCounts> counts)
      : options_(options), camera_(tube_camera(options.camera)), counts_(std::move(counts)) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  Result<std::optional<TimedImage>> next() override {
    if (next_ == options_.fails_at) return error("{}: frame {} is damaged", name_, next_);
    if (next_ == options_.num_frames) return std::optional<TimedImage>();
    ++counts_->images;
    const Mask mask = render_silhouette(body_, camera_, tube_pose(next_++));
    ByteImage image(mask.width(), mask.height(), 3, 0);
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) {
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = mask.get(x, y) ? 255 : 0;
      }
    }
    return std::optional(TimedImage{.image = std::move(image), .time_ns = {}});
  }
  Result<void> rewind() override {
    next_ = 0;
    return {};
  }
  [[nodiscard]] double fps() const override { return 30; }
  [[nodiscard]] int64_t num_frames_hint() const override { return options_.num_frames; }

 private:
  Options options_;
  PinholeCamera camera_;
  std::shared_ptr<PassCounts> counts_;
  BodyModel body_ = make_test_body();
  std::string name_ = "tube";
  int64_t next_ = 0;
};

// Records which calls it received; fails at one of them.
class RecordingSink : public SessionSink {
 public:
  Result<void> add_observed(const Frame& frame, std::span<const Observation> observations) override {
    if (frame.index == fails_at) return error("no space left on device");
    observed.push_back(frame.index);
    num_cameras = observations.size();
    return {};
  }
  Result<void> add_report(const StepReport& report) override {
    reported.push_back(report.frame_idx);
    return {};
  }
  Result<void> add_tracked(const Frame& frame, const StepReport& report) override {
    EXPECT_EQ(frame.index, report.frame_idx);
    tracked.push_back(frame.index);
    return {};
  }
  [[nodiscard]] bool needs_tracked_frames() const override { return needs_frames; }
  Result<void> finish() override {
    is_finished = true;
    return {};
  }

  std::vector<int64_t> observed, reported, tracked;
  size_t num_cameras = 0;
  int64_t fails_at = -1;
  bool needs_frames = true, is_finished = false;
};

// Asks to stop at the update number `stops_at` of what is called `what`, and from then on.
class StoppingProgress : public ProgressSink {
 public:
  StoppingProgress(std::string what, int64_t stops_at) : what_(std::move(what)), stops_at_(stops_at) {}
  bool update(std::string_view what, int64_t done, int64_t /*total*/) override {
    stopped_ = stopped_ || (what == what_ && done >= stops_at_);
    return !stopped_;
  }

 private:
  std::string what_;
  int64_t stops_at_;
  bool stopped_ = false;
};

}  // namespace silpose
