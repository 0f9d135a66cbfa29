// RunSettings: all that distinguishes one run of an experiment from another, apart from its seed: the sequence and how
// its masks are degraded, or the recorded clip and how it is segmented; and the tracker. These are the keys of [run] in
// experiments/NAME.toml (docs/formats.md). Threads: values and functions without state.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace silpose {

struct RunSettings {
  // The sequence.
  std::string model = "human";    // the body that is seen
  bool drawn_person = false;      // a person of its stature with other proportions (synth/drawn_person.h) is seen
  std::string motion = "static";  // synth/motion_source.h; one with a file extension lies under the data folder
  int frames = 0;                 // 0: all of a file, 80 of any other motion
  double fps = 30;
  std::optional<double> amplitude_deg, period_s;
  std::optional<std::array<double, 2>> range;  // of a dof: motion, m or degrees, in place of the DOF's limits
  std::vector<std::string> views = {"front"};  // one camera each
  int width = 640, height = 480;               // pixels
  double focal_px = 700, distance_m = 5.5;
  // The masks.
  std::string mask_noise = "none";  // synth/degraded_mask.h: none, shadow, edge, limb, hole
  double mask_iou = 0.9;            // of edge: with the true masks, on average
  bool faults_known = false;        // wrong pixels, and those within 2 pixels of them, are ignored
  bool keypoints = false;           // with each mask, those that a network might see (synth/simulated_keypoints.h)
  // A recorded clip in place of both. Paths are relative to the data folder.
  std::vector<std::string> clip;          // one video per camera, in step; empty: the run is on a rendered sequence
  std::string camera;                     // calibration: .toml, or .json as docs/formats.md says
  std::vector<std::string> camera_names;  // of the calibration, one per video; empty: all, in their order
  std::string truth;                      // a folder with joints.csv, or with surfaces as numbered .ply files
  std::optional<double> truth_above;      // m: of surfaces, only what lies above this y of the world counts
  std::string segmenter = "learned";      // learned, background, or masks: the videos are masks
  std::vector<std::string> background;    // for `background`: auto, or a picture of the empty scene, one per video
  std::optional<bool> floor;              // the world's y = 0 is the floor; unset: as the preset has it
  // The tracker.
  std::string evidence = "both";  // where there are keypoints: silhouette, landmarks, both; of a clip also network: no
                                  // tracker runs, the network's own keypoints are scored
  bool fit_body = false;          // track/body_fit.h: the clip is tracked, the body fitted, and the clip tracked again
  std::string preset = "default";
  std::optional<bool> smooth;
  std::optional<int> hypotheses;
  std::optional<int> particles, layers;
  std::optional<int> vertices;              // of the mesh that is compared; 0: all
  double body_height = 1, body_weight = 1;  // the tracker's body over the true one
  std::string start = "tracker";            // "tracker": by itself; "truth": the true first pose is given

  [[nodiscard]] bool is_recorded() const { return !clip.empty(); }
  bool operator==(const RunSettings&) const = default;
};

// True for a motion that is a motion-capture file.
bool is_motion_file(const std::string& motion);

// One line of JSON with every setting: equal exactly when the settings are.
std::string settings_text(const RunSettings& settings);

}  // namespace silpose
