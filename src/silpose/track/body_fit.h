// fit_body(): how long the subject's bones are, from a tracked clip: lengths that all instants share and each instant's
// pose are fitted together to the silhouettes. Two cameras or more tell lengths from depth; one does not, unless the
// subject turns.
// Based on: bundle adjustment, whose poses are eliminated by the Schur complement (references.bib: triggs2000).
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/track/track_clip.h"

namespace silpose {

struct BodyFitOptions {
  size_t num_instants = 16;  // taken from the clip, evenly: neighbours tell the same
  bool floor = false;        // nothing lies below it
};

struct BodyFit {
  std::shared_ptr<const BodyModel> body;  // the whole mesh, with these lengths
  std::vector<std::string> names;         // [S] "right_shin_length"
  std::vector<double> lengths;            // [S] metres longer than `body` had them, body/stretchable.h
  std::vector<double> deviations;         // [S] of what is not known of them
};

// `poses` [T][D] are those of the clip's instants; an empty one leaves its instant out, and so does a subject whom
// fewer than two cameras see. Nothing where no instant is left. Lengths stay within three deviations. Errors: throws
// std::invalid_argument where poses do not fit the clip or the body.
std::optional<BodyFit> fit_body(const std::shared_ptr<const BodyModel>& body, const std::vector<PinholeCamera>& cameras,
                                std::span<const ClipInstant> clip, std::span<const std::vector<double>> poses,
                                const BodyFitOptions& options = {}, const std::function<bool()>& proceed = {});

}  // namespace silpose
