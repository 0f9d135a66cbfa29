#include "silpose/session/result_files.h"

#include "silpose/exchange/bvh.h"
#include "silpose/exchange/glb.h"
#include "silpose/exchange/mot.h"
#include "silpose/exchange/tables.h"
#include "silpose/exchange/trc.h"
#include "silpose/geometry/calibration_file.h"

namespace silpose {

Result<void> write_result_files(const std::filesystem::path& folder, const TrackedClip& clip) {
  const auto& [recording, body, cameras, fps] = clip;
  Result<void> kept = write_cameras(folder / "camera.toml", cameras);
  if (!kept || recording.steps.empty()) return kept;
  const Skeleton& skeleton = body.skeleton;
  const PoseTable poses = pose_table(recording);
  const Result<void> files[] = {
      write_poses(folder / "poses.csv", skeleton, poses),
      write_poses(folder / "poses_normalised.csv", skeleton, normalised_pose_table(recording, skeleton),
                  PoseUnits::kNormalised),
      write_poses(folder / "spread.csv", skeleton, spread_table(recording)),
      write_joints(folder / "joints.csv", joint_table(recording, body, cameras[0])),
      write_bvh(folder / "motion.bvh",
                clip_from_poses(skeleton, even_poses(recording, skeleton, fps), fps, body.end_points)),
      write_glb(folder / "motion.glb", body, poses),
      write_trc(folder / "markers.trc", marker_table(recording, body), fps),
      has_opensim_coordinates(skeleton) ? write_mot(folder / "motion.mot", skeleton, poses) : Result<void>(),
  };
  for (const Result<void>& file : files) {
    if (!file) return file;
  }
  return {};
}

}  // namespace silpose
