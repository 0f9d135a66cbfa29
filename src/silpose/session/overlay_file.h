// OverlayFile: the first camera's images with the tracked body drawn on them, as overlay.mp4.
// Threads: as SessionSink.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/render/silhouette.h"
#include "silpose/session/sink.h"
#include "silpose/video/video.h"

namespace silpose {

inline constexpr std::string_view kOverlayFile = "overlay.mp4";

struct OverlayOptions {
  double fps = 30;     // nominal; frames keep their own times
  bool floor = false;  // draw the floor y = 0 around the subject, and its footprints
};

class OverlayFile : public SessionSink {
 public:
  // `camera`: the first one's.
  OverlayFile(std::filesystem::path folder, std::shared_ptr<const BodyModel> body, PinholeCamera camera,
              OverlayOptions options);

  // Errors: those of create_video() and VideoWriter.
  Result<void> add_tracked(const Frame& frame, const StepReport& report) override;
  [[nodiscard]] bool needs_tracked_frames() const override { return true; }
  void set_body(std::shared_ptr<const BodyModel> body) override;
  Result<void> finish() override;

 private:
  void draw(std::span<const double> pose);

  std::filesystem::path folder_;
  std::shared_ptr<const BodyModel> body_;
  PinholeCamera camera_;
  OverlayOptions options_;
  ByteImage image_;                                         // drawn on
  Eigen::Vector2d floor_middle_ = Eigen::Vector2d::Zero();  // x, z: below the subject's root, where it was seen last
  std::optional<BatchRenderer> renderer_;                   // of body_; made when first needed
  std::optional<VideoWriter> video_;
};

}  // namespace silpose
