// The report: one HTML file that opens without network: the overlay video, every angle's curve with its spread, how
// well the silhouettes agree, how many particles carry the estimate, where the time went, and what to be wary of. Made
// of a recording and run facts alone. Drawn by a small script of our own inside the page. Threads: functions without
// state.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/skeleton.h"
#include "silpose/recording/track_recording.h"

namespace silpose {

struct ReportInput {
  std::string title;  // of the page: the clip's name
  const TrackRecording* recording = nullptr;
  const Skeleton* skeleton = nullptr;
  std::filesystem::path overlay_video;                     // embedded when small, linked by its file name when not
  double fps = 30;                                         // of the overlay video
  std::vector<std::pair<std::string, std::string>> facts;  // the run, as lines of a table: name, text
  std::vector<std::pair<std::string, double>> stages_s;    // seconds by stage, in order
  std::vector<std::string> warnings;
  int64_t embed_limit_bytes = 20'000'000;  // of the video
};

// The page as text. REQUIRES: recording and skeleton. Errors: the overlay video cannot be read.
Result<std::string> make_report(const ReportInput& input);

// Errors: those of make_report; not writable.
Result<void> write_report(const std::filesystem::path& path, const ReportInput& input);

}  // namespace silpose
