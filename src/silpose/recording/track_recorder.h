// TrackRecorder: step reports onto a Blackboard as typed entries, and back as a TrackRecording.
// Threads: one thread per recorder; the board may be shared.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sadb/board/blackboard.h"
#include "silpose/base/result.h"
#include "silpose/recording/track_recording.h"
#include "silpose/track/step_report.h"

namespace silpose {

struct RecorderOptions {
  std::string prefix = "tracker";  // of every path
  bool masks = true;               // the observed masks go onto the board too: 1 bit per pixel, frame and camera
};

// Entries are stamped with the frame's time:
//   PREFIX/frame, PREFIX/visual_accuracy, PREFIX/effective_sample_size, PREFIX/trust/CAMERA   scalar
//   PREFIX/state                                                            text, see state_name()
//   PREFIX/pose, PREFIX/mode                                                pose, not while waiting
//   PREFIX/spread, PREFIX/landmark_spread (metres; x, y, z of each)         vector, not while waiting
//   PREFIX/observed/CAMERA                                                  mask
class TrackRecorder {
 public:
  TrackRecorder(std::shared_ptr<sadb::Blackboard> board, std::string skeleton, std::vector<std::string> camera_names,
                RecorderOptions options = {});

  // Errors: those of the board.
  Result<void> put(const StepReport& report);

 private:
  std::shared_ptr<sadb::Blackboard> board_;
  std::string skeleton_;
  std::vector<std::string> camera_names_;
  RecorderOptions options_;
};

// Errors: those of the board; nothing recorded under the prefix; entries of other types than above.
Result<TrackRecording> read_recording(const sadb::Blackboard& board, const std::string& prefix = "tracker");

}  // namespace silpose
