// MaskFiles: the masks of a session as files, and examples of them for a report. A session that tracks a clip as a
// whole resumes from these files.
// Threads: as SessionSink; the rest from one thread while no session runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "silpose/geometry/camera.h"
#include "silpose/recording/mask_strip.h"
#include "silpose/session/sink.h"

namespace silpose {

// Folders of a result; with several cameras "masks_NAME", "confidence_NAME".
inline constexpr std::string_view kMaskFolder = "masks";
// The confidence of each pixel of a mask: only while a clip that is tracked as a whole is not done.
inline constexpr std::string_view kConfidenceFolder = "confidence";

// What an observation holds in addition to its mask, confidence and ignored pixels.
struct MaskSidecar {
  Trust trust;
  std::vector<Keypoint2D> keypoints_2d;
  Keypoints3D keypoints_3d;

  static auto members(auto& b) { return std::tie(b.trust, b.keypoints_2d, b.keypoints_3d); }
};

class MaskFiles : public SessionSink {
 public:
  // masks/000042.png in `folder` for frame 42.
  MaskFiles(std::filesystem::path folder, const std::vector<PinholeCamera>& cameras);

  // From now on the confidence is written, too, for read().
  void keep_confidence() { keeps_confidence_ = true; }

  // Errors: not writable.
  Result<void> add_observed(const Frame& frame, std::span<const Observation> observations) override;
  [[nodiscard]] std::string state() const override;
  void restore(std::string_view state) override;

  // The observations of a frame that add_observed() wrote, in this process or an earlier one, without ignored pixels.
  // [C] Errors: a file that cannot be read or has another size than the frame's images.
  [[nodiscard]] Result<std::vector<Observation>> read(const Frame& frame, std::span<const MaskSidecar> sidecars) const;

  // Examples of each camera's masks, [C].
  [[nodiscard]] const std::vector<MaskStrip>& strips() const { return strips_; }

 private:
  [[nodiscard]] std::filesystem::path file_of(std::string_view folder, size_t camera, int64_t frame_idx) const;

  std::filesystem::path folder_;
  std::vector<std::string> cameras_;  // names
  std::vector<MaskStrip> strips_;     // [C]
  bool keeps_confidence_ = false;
};

}  // namespace silpose
