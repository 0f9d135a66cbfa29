// fit_body(): the lengths of a subject's bones and the girths around them, from a tracked clip. Lengths, which all
// instants share, and the pose of each instant are fitted together to the observations; girths are fitted in turn with
// them. Two cameras or more determine lengths by triangulation. One camera does with a network's keypoints: a leg that
// is longer than its silhouette must lean in every instant, which contradicts the directions of the keypoints. Based
// on: bundle adjustment, with poses eliminated by the Schur complement (references.bib: triggs2000). Threads: a
// function without state; uses all cores and gives the same result on any number.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/offline/clip_instant.h"
#include "silpose/offline/size_fit.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

struct BodyFit {
  std::shared_ptr<const BodyModel> body;  // the whole mesh, fitted
  std::vector<std::string> names;         // [S] "right_shin_length"
  std::vector<double> lengths;            // [S] metres longer than in the body as given (after `size`)
  std::vector<double> deviations;         // [S] standard deviations of these, metres
  struct Girth {
    std::string name;                 // "thigh", both of them
    double share = 0, deviation = 0;  // thicker than in the body as given, body/girth.h
  };
  std::vector<Girth> girths;    // [G]
  std::optional<SizeFit> size;  // of one camera's subject of unknown height, by the floor
  double size_deviation = 0;    // TrackerOptions' for the fitted body
};

// Fits the body of `options` with their cameras, floor, evidence and size_deviation. `poses` [T][D] are those of the
// clip's instants, tracked as options_before_fit() says; empty: none. About 16 instants are used, evenly spread, and no
// keypoints of frames in which the network exchanged left and right (judged_clip.h).
// Several cameras: instants in which at least two see the subject. One camera: first the size by the floor, where it is
// known and the height is not; then lengths and girths from instants with 3D keypoints, at the same stature up to
// size_deviation. Lengths stay within three prior deviations (body/stretchable.h).
// `proceed`: false stops the fit early. Nothing where the clip does not constrain the body.
// Errors: throws std::invalid_argument where poses or observations do not fit the clip, the body or the cameras.
std::optional<BodyFit> fit_body(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                std::span<const std::vector<double>> poses, const std::function<bool()>& proceed = {});

// For the pass that finds the poses of fit_body(): online, on a coarse mesh; with one camera without a floor
// (size_fit.h).
TrackerOptions options_before_fit(const TrackerOptions& options);

// Why fit_body() found nothing, for the user. REQUIRES: it did, with these options.
std::string why_not_fitted(const TrackerOptions& options);

// The same options with the fitted body.
TrackerOptions options_after_fit(TrackerOptions options, const BodyFit& fit);

}  // namespace silpose
