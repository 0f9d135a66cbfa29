// TrackingRuns: runs of an experiment, each from its settings to its scores: makes the sequence and its masks, or
// segments the recorded clip; tracks it in process, and scores the result. Threads: one thread; a run itself uses all
// cores and, times apart, gives the same result on any number.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/experiment/clip_reader.h"
#include "silpose/experiment/recorded_clip.h"
#include "silpose/experiment/run_result.h"
#include "silpose/experiment/run_settings.h"
#include "silpose/offline/clip_instant.h"
#include "silpose/synth/scene.h"

namespace silpose {

// The body of a model's name ("human:height=1.8").
using BodySource = std::function<Result<std::shared_ptr<const BodyModel>>(const std::string& model)>;

class TrackingRuns {
 public:
  // `data`: the folder of motion-capture files and recorded clips; empty where none was given. `networks`: that of the
  // segmenter's networks.
  TrackingRuns(BodySource bodies, std::filesystem::path data, const std::filesystem::path& networks = {})
      : bodies_(std::move(bodies)), data_(std::move(data)), clips_(networks.string()) {}

  // The seed is that of the motion, the masks' noise and the tracker. `go_on` is asked after each frame; when it says
  // false there is no result. Scores: those of score_run(), frames_per_second (the tracker alone), start_s, mask_iou
  // (of the masks given to the tracker, first camera) and, of motion capture, retargeting_residual_deg. Of a recorded
  // clip: those of score_clip() and the tracker's times or, of kind `keypoints`, those of score_keypoints(). The body's
  // height counts as known. Errors: a body, motion, view or option that is not there; the
  // motion does not fit into the image. Of a clip: those of read_clip_cameras(), read_clip_truth() and
  // ClipReader::read(); videos of another size than their cameras.
  Result<std::optional<RunResult>> run(const RunSettings& settings, uint64_t seed, const std::function<bool()>& go_on);

 private:
  // A sequence with its masks, kept for the next run, which often differs in the tracker only.
  struct Seen {
    std::string key;
    SyntheticSequence sequence;
    std::vector<ClipInstant> instants;
    std::optional<double> residual_deg;
    double mask_iou = 1;
  };
  // A recorded clip, segmented, and what is known of it.
  struct RecordedClip {
    std::shared_ptr<const BodyModel> body;
    std::vector<PinholeCamera> cameras;  // [C]
    ClipTruth truth;
    std::vector<ClipInstant> instants;
  };
  using Outcome = Result<std::optional<RunResult>>;
  // By kind of run.
  Outcome track_sequence(const RunSettings& settings, uint64_t seed, const std::function<bool()>& go_on);
  Outcome run_recorded(const RunSettings& settings, uint64_t seed, const std::function<bool()>& go_on);
  static Outcome track_recorded(const RunSettings& settings, const RecordedClip& recorded, uint64_t seed,
                                const std::function<bool()>& go_on);
  static Outcome score_network(const RecordedClip& recorded);
  Result<std::optional<RecordedClip>> read_clip(const RunSettings& settings, const std::function<bool()>& go_on);
  Result<const Seen*> see(const RunSettings& settings, uint64_t seed);
  Result<std::shared_ptr<const BodyModel>> body(const std::string& model);

  BodySource bodies_;
  std::filesystem::path data_;
  std::map<std::string, std::shared_ptr<const BodyModel>> kept_bodies_;
  std::optional<Seen> seen_;
  ClipReader clips_;
};

}  // namespace silpose
