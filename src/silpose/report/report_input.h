// ReportInput: what a report is made of: a recording, its body, and facts about the run.
// Threads: a value.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/recording/mask_strip.h"
#include "silpose/recording/track_recording.h"

namespace silpose {

using FactLines = std::vector<std::pair<std::string, std::string>>;  // lines of a table: name, text

struct ReportInput {
  std::string title;  // of the page: the clip's name
  const TrackRecording* recording = nullptr;
  const BodyModel* body = nullptr;
  std::optional<Eigen::Vector3d> viewpoint;  // of the first camera, world: the skeleton is first shown from there
  std::filesystem::path overlay_video;       // one image per step, from time 0; embedded if small, else linked by name
  double fps = 30;                           // of the clip, where it is constant
  FactLines facts;                           // the run
  FactLines mask_facts;                      // how the masks were made: the segmenter and its settings
  std::vector<std::pair<std::string, std::vector<MaskExample>>> strips;  // by camera: name, examples
  std::vector<std::pair<std::string, std::string>> downloads;            // files next to the page: name, what it holds
  std::vector<std::pair<std::string, double>> stages_s;                  // seconds by stage, in order
  std::vector<std::string> warnings;
  int64_t embed_limit_bytes = 20'000'000;  // of the video
};

}  // namespace silpose
