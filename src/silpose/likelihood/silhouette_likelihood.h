// SilhouetteLikelihood: how well poses explain the observed silhouettes. states [N, D] -> silhouettes -> distances ->
// log-likelihood [N]; several cameras are summed.
// Source: pixel-count distance, eq. 2.4; weights, eq. 2.14 with a sharpness (references.bib: cormier2019).
// Threads: constant after construction; all functions may be called from any thread.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/filter/state_batch.h"
#include "silpose/image/observation.h"
#include "silpose/likelihood/keypoint_term.h"
#include "silpose/render/silhouette.h"

namespace silpose {

// What the two silhouettes are compared on.
enum class Comparison {
  kImage,    // the whole image: position and scale count
  kCropped,  // both cropped to their boxes and scaled to a common size, as the thesis does: only the shape counts
};

// What differs.
enum class Metric {
  kPixelCount,  // pixels: set in one of both only
  kCoverage,    // parts of pixels: |covered by one - covered by the other|, which motion of a tenth of a pixel changes.
                // At a quarter of the resolution it still locates a body better.
};

struct LikelihoodOptions {
  Comparison comparison = Comparison::kImage;
  Metric metric = Metric::kPixelCount;
  double sharpness = 40;  // log-likelihood of a silhouette that shares no pixel with the observed one is -sharpness
  int resolution = 128;   // raster pixels along the longer side of the observed silhouette
  EvidenceKind evidence = EvidenceKind::kSilhouette;
  // Errors: throws std::invalid_argument.
  void check() const;
};

// The observations of one instant in the form that comparisons need.
struct Evidence {
  struct View {
    Window window;                                  // of the rasters below, in image pixels
    Mask observed;                                  // raster; for Metric::kPixelCount
    ByteImage covered;                              // raster, 0 to kFullCoverage; for Metric::kCoverage
    int64_t area = 0;                               // set pixels, or the sum of what is covered
    Mask ignored;                                   // raster pixels that do not count in `observed`; empty: none
    ByteImage ignored_coverage;                     // the same for `covered`
    double trust = 0;                               // 0: this camera is ignored
    std::shared_ptr<const KeypointTerm> keypoints;  // null: none
  };
  std::vector<View> views;  // [C]
};

class SilhouetteLikelihood {
 public:
  // REQUIRES: at least one renderer, all of the same body.
  SilhouetteLikelihood(std::vector<std::shared_ptr<const BatchRenderer>> renderers, LikelihoodOptions options);

  // Shapes: one observation per camera. A camera whose observation found nothing is ignored. Ignored pixels do not
  // count where whole images are compared; cropped silhouettes have no common pixels to leave out.
  [[nodiscard]] Evidence prepare(std::span<const Observation> observations) const;

  // Distance in [0, 1] of each state, mean over the cameras that are used: what differs over the sum of both areas (0
  // if equal, 1 if disjoint). Shapes: states [N, D' >= D], only the first D columns are read; out [N].
  void distances(const Evidence& evidence, const StateBatch& states, std::span<double> out) const;

  // -sharpness * trust * distance, summed over cameras, plus the term of keypoints. Shapes: as distances().
  void log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const;

  // log-likelihood and its derivative with respect to the pose, by central differences over `steps` [D].
  struct Derivative {
    double log_likelihood = 0;
    Eigen::VectorXd gradient;  // [D]
  };
  [[nodiscard]] Derivative derivative(const Evidence& evidence, std::span<const double> pose,
                                      std::span<const double> steps) const;

  [[nodiscard]] const LikelihoodOptions& options() const { return options_; }
  [[nodiscard]] const BodyModel& body() const { return renderers_.front()->body(); }
  [[nodiscard]] std::span<const std::shared_ptr<const BatchRenderer>> renderers() const { return renderers_; }

 private:
  // Sum over cameras of the distance, times the camera's trust when `weighted`.
  void accumulate(const Evidence& evidence, const StateBatch& states, bool weighted, std::span<double> out) const;

  std::vector<std::shared_ptr<const BatchRenderer>> renderers_;
  LikelihoodOptions options_;
};

}  // namespace silpose
