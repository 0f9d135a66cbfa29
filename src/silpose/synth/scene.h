// SyntheticSequence: a moving body in front of one or several cameras, and its ground truth: masks and joints.
// Images of it are drawn in colour_scene.h; files are written in sequence_files.h.
// Threads: a value and functions without state.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/mask.h"
#include "silpose/synth/motion_source.h"

namespace silpose {

// A camera's position around the middle of the path: 0 sees the front of a resting subject, 90 its left side. Degrees.
struct View {
  std::string name;
  double azimuth_deg = 0;
};

// "front", "side" (the subject's left) or degrees; the view is named by its text.
// Errors: neither a known word nor a finite number.
Result<View> parse_view(const std::string& text);

struct SceneOptions {
  int width = 640, height = 480;  // pixels
  double focal_px = 700;
  double distance_m = 5.5;  // from the middle of the clip's path
  std::vector<View> views = {{"front", 0}};
  int lead_in = 0;  // frames before the motion, without the subject
};

struct SyntheticSequence {
  std::shared_ptr<const BodyModel> body;
  std::vector<std::vector<double>> poses;  // [T][D], of the motion; the first belongs to frame `lead_in`
  std::vector<PinholeCamera> cameras;      // [C], named as their views
  double distance_m = 0;                   // of the cameras
  double fps = 30;
  int lead_in = 0;

  [[nodiscard]] int num_frames() const { return lead_in + static_cast<int>(poses.size()); }
};

// Cameras look level at the middle of the box around all that is seen of the body. They are farther away than requested
// where some frame would not fit into the image. Errors: no frame; a body that does not fit from 200 m away; throws
// std::invalid_argument for sizes that are not positive, no view, or two of one name.
Result<SyntheticSequence> make_sequence(std::shared_ptr<const BodyModel> body, const SyntheticMotion& motion,
                                        const SceneOptions& options = {});

// The pose of frame `frame` (counted from the video's first image); empty in the lead-in.
std::span<const double> pose_of_frame(const SyntheticSequence& sequence, int frame);

// The true silhouette, of the body's whole mesh; empty in the lead-in.
Mask true_mask(const SyntheticSequence& sequence, int camera_idx, int frame);

}  // namespace silpose
