#include "apps/silpose/track_writer.h"

#include <fmt/format.h>

#include <utility>

#include "silpose/exchange/bvh.h"
#include "silpose/exchange/glb.h"
#include "silpose/exchange/mot.h"
#include "silpose/exchange/trc.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/image/image_file.h"
#include "silpose/render/draw_floor.h"
#include "silpose/render/draw_overlay.h"
#include "silpose/render/silhouette.h"

namespace silpose::app {
namespace {

constexpr std::string_view kMaskFolder = "masks";

}  // namespace

TrackWriter::TrackWriter(std::filesystem::path directory, std::shared_ptr<const BodyModel> body,
                         std::vector<PinholeCamera> cameras, double fps, bool draws_floor)
    : directory_(std::move(directory)),
      body_(std::move(body)),
      cameras_(std::move(cameras)),
      fps_(fps),
      draws_floor_(draws_floor),
      strips_(cameras_.size()) {}

std::filesystem::path TrackWriter::file_of(std::string_view folder, size_t camera, int64_t frame_idx) const {
  std::string name(folder);
  if (cameras_.size() > 1) name += "_" + cameras_[camera].name;
  return directory_ / name / fmt::format("{:06}.png", frame_idx);
}

Result<void> TrackWriter::add_masks(const Frame& frame, std::span<const Observation> observations) {
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const auto file = file_of(kMaskFolder, c, frame.index);
    std::error_code failed;
    std::filesystem::create_directories(file.parent_path(), failed);
    const Result<void> written = write_mask(file, observations[c].mask);
    if (!written) return written.failure();
    strips_[c].add(frame.index, static_cast<double>(frame.time_ns) * 1e-9, frame.images[c], observations[c].mask);
    if (!keeps_confidence_ || observations[c].confidence.empty()) continue;
    const auto of_confidence = file_of(kConfidenceFolder, c, frame.index);
    std::filesystem::create_directories(of_confidence.parent_path(), failed);
    if (Result<void> kept = write_image(of_confidence, observations[c].confidence); !kept) return kept;
  }
  return {};
}

Result<std::vector<Observation>> TrackWriter::read_masks(int64_t frame_idx,
                                                         std::span<const MaskSidecar> sidecars) const {
  std::vector<Observation> observations(cameras_.size());
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const auto file = file_of(kMaskFolder, c, frame_idx), of_confidence = file_of(kConfidenceFolder, c, frame_idx);
    Result<Mask> mask = read_mask(file);
    if (!mask) return mask.failure();
    std::error_code ignored;
    if (std::filesystem::exists(of_confidence, ignored)) {
      Result<ByteImage> confidence = read_grey_image(of_confidence);
      if (!confidence) return confidence.failure();
      observations[c].confidence = std::move(*confidence);
    }
    const auto fits = [&](const auto& image) {
      return image.width() == cameras_[c].width && image.height() == cameras_[c].height;
    };
    if (!fits(*mask) || !(observations[c].confidence.empty() || fits(observations[c].confidence))) {
      return error("{}: {}x{}, the pictures {}x{}", file.string(), mask->width(), mask->height(), cameras_[c].width,
                   cameras_[c].height);
    }
    observations[c].mask = std::move(*mask);
    observations[c].trust = sidecars[c].trust;
    observations[c].keypoints_2d = sidecars[c].keypoints_2d;
    observations[c].keypoints_3d = sidecars[c].keypoints_3d;
  }
  return observations;
}

Result<void> TrackWriter::add_picture(ByteImage picture, int64_t time_ns, std::span<const double> pose) {
  const PinholeCamera& camera = cameras_[0];
  Mask subject;
  if (!pose.empty()) {
    if (!renderer_) renderer_.emplace(body_, camera);
    subject = renderer_->silhouette(pose);
  }
  if (draws_floor_) {
    if (!pose.empty()) {
      const Eigen::Vector3d root = landmark_positions(*body_, pose)[0];
      floor_middle_ = {root.x(), root.z()};
    }
    draw_floor(picture, camera, floor_middle_, subject);
  }
  if (!pose.empty()) {
    draw_outline(picture, subject);
    draw_bones(picture, *body_, camera, pose);
  }
  if (draws_floor_ && !pose.empty()) draw_footprints(picture, *body_, camera, pose);
  if (!overlay_) {
    Result<VideoWriter> created = create_video(directory_ / "overlay.mp4", picture.width(), picture.height(), fps_);
    if (!created) return created.failure();
    overlay_.emplace(std::move(*created));
  }
  return overlay_->write(picture, time_ns);
}

void TrackWriter::set_fitted_body(std::shared_ptr<const BodyModel> body) {
  body_ = std::move(body);
  renderer_.reset();
  is_fitted_ = true;
}

Result<void> TrackWriter::finish(const TrackRecording& recording) {
  if (overlay_) {
    if (Result<void> closed = overlay_->close(); !closed) return closed;
  }
  Result<void> kept = write_cameras(directory_ / "camera.toml", cameras_);
  if (!kept || recording.steps.empty()) return kept;
  if (is_fitted_) {
    Result<void> written = write_body(directory_ / kFittedBodyFile, *body_);
    if (!written) return written;
  }
  const Skeleton& skeleton = body_->skeleton;
  const PoseTable poses = pose_table(recording);
  const Result<void> files[] = {
      write_poses(directory_ / "poses.csv", skeleton, poses),
      write_poses(directory_ / "poses_normalised.csv", skeleton, normalised_pose_table(recording, skeleton),
                  PoseUnits::kNormalised),
      write_poses(directory_ / "spread.csv", skeleton, spread_table(recording)),
      write_joints(directory_ / "joints.csv", joint_table(recording, *body_, cameras_[0])),
      write_bvh(directory_ / "motion.bvh",
                clip_from_poses(skeleton, even_poses(recording, skeleton, fps_), fps_, body_->end_points)),
      write_glb(directory_ / "motion.glb", *body_, poses),
      write_trc(directory_ / "markers.trc", marker_table(recording, *body_), fps_),
      has_opensim_coordinates(skeleton) ? write_mot(directory_ / "motion.mot", skeleton, poses) : Result<void>(),
  };
  for (const Result<void>& file : files) {
    if (!file) return file;
  }
  return {};
}

}  // namespace silpose::app
