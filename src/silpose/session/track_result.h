// What the directory of a track records about the run, besides the recording's own files: the facts of run.json, and
// report.html.
// Threads: values and functions without state.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/session/mask_files.h"
#include "silpose/session/run_facts.h"
#include "silpose/session/session.h"
#include "silpose/session/track_job.h"

namespace silpose {

// What the facts and the report are made of.
struct FinishedTrack {
  const ProgramRun& program;
  const TrackJob& job;
  const MaskFiles& masks;
  const SessionResult& result;
  std::map<std::string, std::string> chosen;  // chosen_options(), of the tracker as used
  std::vector<std::string> warnings;          // warnings_of()
};

double frames_per_second(const SessionResult& result);

// `out`: the directory as the user names it.
nlohmann::ordered_json facts_of(const FinishedTrack& track, const std::string& out);

// report.html in `folder`, with the overlay and links to the files that are there. Errors: those of write_report().
Result<void> write_track_report(const FinishedTrack& track, const std::filesystem::path& folder);

}  // namespace silpose
