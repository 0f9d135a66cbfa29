// RunSettings: all that distinguishes one run of an experiment from another, apart from its seed: what kind of run it
// is; the sequence and how its masks are degraded, or the recorded clip and how it is segmented; and the tracker. These
// are the keys of [run] in experiments/NAME.toml, listed in docs/options.md. Adding one is a member and a line of a
// table. Threads: values and functions without state; the tables are constant.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"

namespace silpose {

// kTrack: a rendered sequence is tracked. kTrackClip: a recorded clip. kKeypoints: no tracker runs, and a network's own
// keypoints of a recorded clip are scored.
enum class RunKind { kTrack, kTrackClip, kKeypoints };

struct RunSettings {
  std::optional<RunKind> kind;     // unset: kTrack, or kTrackClip with a clip
  std::string model = "human";     // the body that is seen
  int frames = 0;                  // 0: all of a file or clip, 80 of any other motion
  std::string preset = "default";  // track/tracker_presets.h
  GivenOptions tracker;            // by name, on top of the preset
  bool fit_body = false;  // offline/body_fit.h: the clip is tracked, the body fitted, and the clip tracked again
  // The sequence.
  bool drawn_person = false;      // a person of its stature with other proportions (synth/drawn_person.h) is seen
  std::string motion = "static";  // synth/motion_source.h; one with a file extension lies under the data folder
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
  // The tracker of a rendered sequence.
  double body_height = 1, body_weight = 1;  // its body over the true one
  std::string start = "tracker";            // "tracker": by itself; "truth": the true first pose is given
  // A recorded clip. Paths are relative to the data folder.
  std::vector<std::string> clip;          // one video per camera, in step; empty: the run is on a rendered sequence
  std::string camera;                     // calibration: .toml, or .json as docs/formats.md says
  std::vector<std::string> camera_names;  // of the calibration, one per video; empty: all, in their order
  std::string truth;                      // a folder with joints.csv, or with surfaces as numbered .ply files
  std::optional<double> truth_above;      // m: of surfaces, only what lies above this y of the world counts
  std::string segmenter = "learned";      // learned, background, or masks: the videos are masks
  std::vector<std::string> background;    // for `background`: auto, or an image of the empty scene, one per video

  [[nodiscard]] bool is_recorded() const { return !clip.empty(); }
  [[nodiscard]] RunKind run_kind() const {
    return kind.value_or(is_recorded() ? RunKind::kTrackClip : RunKind::kTrack);
  }
  bool operator==(const RunSettings&) const = default;
};

// The settings of every run; of what is seen on a rendered sequence; of its tracker's body and start; of recorded
// clips.
const OptionTable<RunSettings>& run_setting_table();
const OptionTable<RunSettings>& sequence_setting_table();
const OptionTable<RunSettings>& subject_setting_table();
const OptionTable<RunSettings>& clip_setting_table();

// The option of the tracker that a key names: "sigma_deg" or "tracker_sigma_deg" is sigma-deg. A key that is a setting
// of its own needs the prefix: "motion" is the subject's, "tracker_motion" the motion model. Null where there is none.
const OptionInfo* tracker_option_of(std::string_view key);

// True for a motion that is a motion-capture file.
bool is_motion_file(const std::string& motion);

// One line of JSON with every setting: equal exactly when the settings are.
std::string settings_text(const RunSettings& settings);

// The same of the settings that decide what is seen, those of the model and of a rendered sequence.
std::string sequence_text(const RunSettings& settings);

}  // namespace silpose
