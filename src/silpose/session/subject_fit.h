// fit_subject(): a subject's own body from a recorded clip: the clip is segmented and tracked with the body as given,
// which is then fitted (offline/body_fit.h). A Session with SessionOptions::fit_body also tracks the clip again.
// Threads: a function without state; uses all cores.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/offline/body_fit.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/input_options.h"
#include "silpose/session/run_context.h"

namespace silpose {

struct SubjectFitOptions {
  InputOptions input;
  CameraOptions camera;         // with a file
  std::string model = "human";  // choose_body()
  uint64_t seed = 1;

  // Errors: throws OptionError as InputOptions::check(), and where there is no calibration file.
  void check() const;
};

struct SubjectFit {
  BodyFit fit;
  std::vector<std::string> warnings;  // of cameras, input and fit, one line each
};

// Errors: those of choose_body(), open_clip() and the source; no frame; the clip does not determine the body; stopped
// by the progress sink. Throws OptionError as check() and open_clip().
Result<SubjectFit> fit_subject(const SubjectFitOptions& options, const RunContext& context);

}  // namespace silpose
