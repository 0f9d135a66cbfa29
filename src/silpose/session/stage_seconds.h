// StageSeconds: where the time of a session went. Threads: a value.
#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "silpose/track/step_report.h"

namespace silpose {

// Seconds by stage. `camera` (estimating it) and `background` were spent before the first frame, `start` on finding a
// starting pose, `smooth` on tracking a clip as a whole, which is not divided further.
struct StageSeconds {
  double camera = 0, background = 0, decode = 0, segment = 0, start = 0, propagate = 0, likelihood = 0, resample = 0,
         smooth = 0, write = 0;

  void add(const StepSeconds& step) {
    start += step.start;
    propagate += step.propagate;
    likelihood += step.likelihood;
    resample += step.resample;
  }
  [[nodiscard]] std::vector<std::pair<std::string, double>> list() const {
    return {{"camera", camera},         {"background", background},
            {"decode", decode},         {"segment", segment},
            {"start", start},           {"propagate", propagate},
            {"likelihood", likelihood}, {"resample", resample},
            {"smooth", smooth},         {"write", write}};
  }
  static auto members(auto& s) {
    return std::tie(s.camera, s.background, s.decode, s.segment, s.start, s.propagate, s.likelihood, s.resample,
                    s.smooth, s.write);
  }
};

}  // namespace silpose
