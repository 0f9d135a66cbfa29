// TrackRecorder: step reports onto a Blackboard as typed entries, and back as a TrackRecording.
// Threads: one thread per recorder; the board may be shared.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sadb/board/blackboard.h"
#include "silpose/base/result.h"
#include "silpose/body/skeleton.h"
#include "silpose/recording/track_recording.h"
#include "silpose/track/step_report.h"

namespace silpose {

struct RecorderOptions {
  std::string prefix = "tracker";  // of every path
  bool masks = true;               // the observed masks go onto the board too: 1 bit per pixel, frame and camera
};

// Every step is one batch: a reader of the board sees all of its entries or none. Entries are stamped with the frame's
// time:
//   PREFIX/frame, PREFIX/visual_accuracy, PREFIX/effective_sample_size, PREFIX/trust/CAMERA   scalar
//   PREFIX/state                                                            text, see state_name()
//   PREFIX/pose, PREFIX/mode                                                pose, not while waiting
//   PREFIX/spread, PREFIX/landmark_spread (metres; x, y, z of each)         vector, not while waiting
//   PREFIX/observed/CAMERA                                                  mask
// The paths of poses have the skeleton's schema (pose_schema()).
class TrackRecorder {
 public:
  TrackRecorder(std::shared_ptr<sadb::Blackboard> board, const Skeleton& skeleton,
                std::vector<std::string> camera_names, RecorderOptions options = {});

  // Errors: those of the board; poses of another skeleton lie under the prefix.
  Result<void> put(const StepReport& report);

 private:
  std::shared_ptr<sadb::Blackboard> board_;
  sadb::Schema pose_;
  std::vector<std::string> camera_names_;
  RecorderOptions options_;
  bool is_declared_ = false;
};

// What poses of a skeleton are on a board: its DOF in radians and metres, the periodic ones with a period of 2 pi.
sadb::Schema pose_schema(const Skeleton& skeleton);

// Errors: those of the board; nothing recorded under the prefix; entries of other types than above.
Result<TrackRecording> read_recording(const sadb::Blackboard& board, const std::string& prefix = "tracker");

}  // namespace silpose
