// TrackWriter: the files of a track's result directory. Masks and the overlay are written as frames come; everything
// else is made of the recording at the end, also of one that was interrupted.
// Threads: the main thread only.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/silpose/observation_source.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/video.h"
#include "silpose/recording/track_recorder.h"

namespace silpose::app {

class TrackWriter {
 public:
  TrackWriter(std::filesystem::path directory, std::shared_ptr<const BodyModel> body,
              std::vector<PinholeCamera> cameras, double fps);

  // masks/ (masks_NAME/ with several cameras) and one picture of overlay.mp4, of the first camera.
  Result<void> add_frame(const Instant& instant, const StepReport& report);

  // Ends overlay.mp4; writes poses, poses_normalised, spread and joints as CSV, motion.bvh and camera.toml.
  Result<void> write_recording(const TrackRecording& recording);

 private:
  std::filesystem::path directory_;
  std::shared_ptr<const BodyModel> body_;
  std::vector<PinholeCamera> cameras_;
  double fps_;
  std::optional<VideoWriter> overlay_;
};

}  // namespace silpose::app
