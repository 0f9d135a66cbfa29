#include "silpose/session/overlay_file.h"

#include <utility>

#include "silpose/render/draw_floor.h"
#include "silpose/render/draw_overlay.h"

namespace silpose {

OverlayFile::OverlayFile(std::filesystem::path folder, std::shared_ptr<const BodyModel> body, PinholeCamera camera,
                         OverlayOptions options)
    : folder_(std::move(folder)), body_(std::move(body)), camera_(std::move(camera)), options_(options) {}

void OverlayFile::draw(std::span<const double> pose) {
  Mask subject;
  if (!pose.empty()) {
    if (!renderer_) renderer_.emplace(body_, camera_);
    subject = renderer_->silhouette(pose);
  }
  if (options_.floor) {
    if (!pose.empty()) {
      const Eigen::Vector3d root = landmark_positions(*body_, pose)[0];
      floor_middle_ = {root.x(), root.z()};
    }
    draw_floor(image_, camera_, floor_middle_, subject);
  }
  if (pose.empty()) return;
  draw_outline(image_, subject);
  draw_bones(image_, *body_, camera_, pose);
  if (options_.floor) draw_footprints(image_, *body_, camera_, pose);
}

Result<void> OverlayFile::add_tracked(const Frame& frame, const StepReport& report) {
  image_ = frame.images[0];
  draw(report.pose);
  if (!video_) {
    Result<VideoWriter> created = create_video(folder_ / kOverlayFile, image_.width(), image_.height(), options_.fps);
    if (!created) return created.failure();
    video_.emplace(std::move(*created));
  }
  return video_->write(image_, frame.time_ns);
}

void OverlayFile::set_body(std::shared_ptr<const BodyModel> body) {
  body_ = std::move(body);
  renderer_.reset();
}

Result<void> OverlayFile::finish() { return video_ ? video_->close() : Result<void>(); }

}  // namespace silpose
