// TrackWriter: the files of a track's result directory. Masks are written as frames arrive; everything else is made
// from the recording, even if it was interrupted.
// Threads: the main thread only.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"
#include "silpose/recording/track_recorder.h"
#include "silpose/render/silhouette.h"
#include "silpose/report/mask_strip.h"
#include "silpose/video/video.h"

namespace silpose::app {

// The body whose bones were fitted to a clip, in its result directory.
inline constexpr const char* kFittedBodyFile = "fitted.body";
// How certain each pixel of a mask is, while a clip that is tracked as a whole is not done.
inline constexpr std::string_view kConfidenceFolder = "confidence";

// What an observation holds in addition to its mask and confidence.
struct MaskSidecar {
  Trust trust;
  std::vector<Keypoint2D> keypoints_2d;
  Keypoints3D keypoints_3d;

  static auto members(auto& b) { return std::tie(b.trust, b.keypoints_2d, b.keypoints_3d); }
};

class TrackWriter {
 public:
  TrackWriter(std::filesystem::path directory, std::shared_ptr<const BodyModel> body,
              std::vector<PinholeCamera> cameras, double fps,
              bool draws_floor);  // fps: of files that need a constant rate

  // One frame of masks/ (masks_NAME/ with several cameras), and of the examples that strips() has. Shapes: one
  // observation per camera.
  Result<void> add_masks(const Frame& frame, std::span<const Observation> observations);

  // From now on add_masks() keeps the confidence of the masks, too, for read_masks().
  void keep_confidence() { keeps_confidence_ = true; }
  // What add_masks() wrote of a frame, in this process or an earlier one. Shapes: the rest of each camera's
  // observation.
  // Errors: a picture that cannot be read or has another size.
  Result<std::vector<Observation>> read_masks(int64_t frame_idx, std::span<const MaskSidecar> sidecars) const;

  // The next picture of overlay.mp4, of the first camera at its time, with `pose` [D] drawn on it; empty:
  // nothing is. The floor around the subject, and its footprints, are drawn too where that was requested.
  Result<void> add_picture(ByteImage picture, int64_t time_ns, std::span<const double> pose);

  // What is written is of this body from now on; finish() writes it, too, as kFittedBodyFile.
  void set_fitted_body(std::shared_ptr<const BodyModel> body);

  // Ends overlay.mp4; writes camera.toml and, where the recording holds anything, poses, poses_normalised, spread and
  // joints as CSV, motion.bvh, motion.glb, markers.trc and, where the skeleton is the human's, motion.mot.
  Result<void> finish(const TrackRecording& recording);

  [[nodiscard]] const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  [[nodiscard]] const BodyModel& body() const { return *body_; }
  // Of each camera, examples of its masks.
  [[nodiscard]] const std::vector<MaskStrip>& strips() const { return strips_; }
  void restore_strips(std::vector<MaskStrip> strips) { strips_ = std::move(strips); }

 private:
  // The file of a frame's mask, or in kConfidenceFolder its confidence.
  [[nodiscard]] std::filesystem::path file_of(std::string_view folder, size_t camera, int64_t frame_idx) const;

  std::filesystem::path directory_;
  std::shared_ptr<const BodyModel> body_;
  std::vector<PinholeCamera> cameras_;
  double fps_;
  bool draws_floor_, is_fitted_ = false, keeps_confidence_ = false;
  Eigen::Vector2d floor_middle_ = Eigen::Vector2d::Zero();  // x, z: below the subject's root, where it was seen last
  std::vector<MaskStrip> strips_;                           // [C]
  std::optional<BatchRenderer> renderer_;  // of body_, as the first camera sees it; made when first needed
  std::optional<VideoWriter> overlay_;
};

}  // namespace silpose::app
