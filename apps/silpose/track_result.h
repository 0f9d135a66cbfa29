// What a track's directory records about the run: the facts of run.json, the lines on the terminal, and report.html.
// Threads: the main thread only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/silpose/command.h"
#include "apps/silpose/track_options.h"
#include "silpose/session/mask_files.h"
#include "silpose/session/session.h"

namespace silpose::app {

// What the outcome and the report are made of.
struct FinishedTrack {
  const TrackOptions& options;
  const CommonOptions& common;
  const CameraChoice& camera;
  const MaskFiles& masks;
  const ObservationSource& source;
  const SessionResult& tracked;
  std::vector<std::string> warnings;
};

// `folder`: where the files will be when the command ends.
Outcome track_outcome(const FinishedTrack& finished, const std::filesystem::path& folder);

// report.html in `folder`, with the overlay.mp4 that is there. Errors: those of write_report().
Result<void> write_track_report(const FinishedTrack& finished, const std::filesystem::path& folder);

}  // namespace silpose::app
