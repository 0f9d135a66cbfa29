// fit_body(): how long the subject's bones are and how thick the flesh around them, from a tracked clip: lengths that
// all instants share and each instant's pose are fitted together to the observations, in turn with girths. Two cameras
// or more tell lengths from depth. One does where a network's keypoints say how the limbs are turned: a leg that is too
// long for its silhouette must lean in every instant, and the keypoints contradict. Based on: bundle adjustment, whose
// poses are eliminated by the Schur complement (references.bib: triggs2000). Threads: a function without state; uses
// all cores and gives the same result on any number.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/track/size_fit.h"
#include "silpose/track/track_clip.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

struct BodyFitOptions {
  size_t num_instants = 16;                           // taken from the clip, evenly: neighbours tell the same
  bool floor = false;                                 // nothing lies below it
  EvidenceKind evidence = EvidenceKind::kSilhouette;  // with kBoth keypoints count, too
  double size_deviation = 0;                          // TrackerOptions'; only one camera's fit needs it
};

struct BodyFit {
  std::shared_ptr<const BodyModel> body;  // the whole mesh, with these lengths
  std::vector<std::string> names;         // [S] "right_shin_length"
  std::vector<double> lengths;            // [S] metres longer than `body` had them, body/stretchable.h
  std::vector<double> deviations;         // [S] of what is not known of them
  struct Girth {
    std::string name;                 // "thigh", both of them
    double share = 0, deviation = 0;  // thicker than `body` had it, body/girth.h
  };
  std::vector<Girth> girths;    // [G]
  std::optional<SizeFit> size;  // of one camera's subject, by the floor; lengths and girths come on top of it
  double size_deviation = 0;    // of the fitted body, as TrackerOptions have it
};

// `poses` [T][D] are those of the clip's instants; an empty one leaves its instant out, and so does, with several
// cameras, a subject whom fewer than two of them see. Lengths stay within three deviations.
// With one camera poses are those of a tracker that knows of no floor (size_fit.h). A size that is not known is fitted
// by the floor. Lengths and girths are fitted from the instants with 3D keypoints whose sides are not exchanged, if
// those count; the stature stays as it is, up to size_deviation.
// Nothing where the clip tells nothing of the body. Errors: throws std::invalid_argument where poses do not fit the
// clip or the body.
std::optional<BodyFit> fit_body(const std::shared_ptr<const BodyModel>& body, const std::vector<PinholeCamera>& cameras,
                                std::span<const ClipInstant> clip, std::span<const std::vector<double>> poses,
                                const BodyFitOptions& options = {}, const std::function<bool()>& proceed = {});

// What the tracker that finds these poses is asked for, and what fit_body() is then, for a tracker with `options`.
TrackerOptions options_before_fit(const TrackerOptions& options);
BodyFitOptions body_fit_options(const TrackerOptions& options);

}  // namespace silpose
