// Evaluation: how far a tracked result is from the truth, frame by frame, as mean and spread over frames.
// Frames are matched by number; joint errors are over the landmarks of the rig (RigProfile), or those of them that the
// truth has. Threads: values; evaluate() itself uses all cores and gives the same on any number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/exchange/tables.h"
#include "silpose/geometry/camera.h"

namespace silpose {

// What a result or truth directory holds, as plain values; a truth may lack any part.
struct Recorded {
  std::optional<PoseTable> poses;
  std::optional<JointTable> joints;
  std::map<int64_t, std::filesystem::path> mask_files;  // frame number -> image, of the first camera
  std::vector<PinholeCamera> cameras;
};

// Reads poses.csv, joints.csv and camera.toml where they are there, and lists masks/000000.png ... (or, with several
// cameras, masks_NAME/ of the first). Errors: no such directory, none of these in it, a broken file, a joint that is
// neither a joint nor an end point of `body`; landmarks may have the names of OpenPose.
Result<Recorded> read_recorded(const std::filesystem::path& directory, const BodyModel& body);

struct EvaluateOptions {
  double start_s = -std::numeric_limits<double>::infinity();  // frames with start <= time < end count; truth's time
  double end_s = std::numeric_limits<double>::infinity();
};

struct Figure {
  double mean = 0, std = 0;  // over frames; population
};

struct Evaluation {
  int64_t frames = 0;          // of the truth that the result has too
  int64_t frames_missing = 0;  // of the truth that the result lacks
  // In the order of the command's documentation; nothing where the truth (or the result) lacks what it needs:
  // pose_error_npsu, pose_error_deg, angle_error_deg, joint_error_mm, joint_error_root_mm, joint_error_aligned_mm,
  // joint_error_px, visual_accuracy, mask_iou.
  std::vector<std::pair<std::string, std::optional<Figure>>> figures;

  [[nodiscard]] std::optional<Figure> find(std::string_view name) const;
};

// One frame that both sides have: one value per name of figure_names(), nothing where it lacks what it needs.
struct FrameEvaluation {
  int64_t frame = 0;
  std::vector<std::optional<double>> values;
};

// The figures' names in the order above.
std::vector<std::string> figure_names();

// The same figures frame by frame, ascending; frames that the result lacks are left out. Errors: as evaluate().
Result<std::vector<FrameEvaluation>> evaluate_frames(const Recorded& result, const Recorded& truth,
                                                     const BodyModel& body, const EvaluateOptions& options = {});

// Visual accuracy renders the result's poses of `body` through the truth's first camera (the result's, where the truth
// has none); joint_error_px and mask_iou are left out where the first cameras have different names. Errors: a mask that
// cannot be read or has another size than its partner or the camera.
Result<Evaluation> evaluate(const Recorded& result, const Recorded& truth, const BodyModel& body,
                            const EvaluateOptions& options = {});

}  // namespace silpose
