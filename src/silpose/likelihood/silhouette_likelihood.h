// SilhouetteLikelihood: how well poses explain the observed silhouettes, by any metric of shapes. Poses are drawn by a
// backend per camera, on the whole image or each cropped to its own silhouette; distances are summed over cameras.
// Metrics of areas are counted while drawing where the backend can do that.
// Source: weights, cormier2019 eq. 2.14 with a sharpness (references.bib).
// Threads: as PoseLikelihood.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/likelihood/pose_likelihood.h"
#include "silpose/render/render_backend.h"
#include "silpose/shape/shape_metric.h"

namespace silpose {

// What the two silhouettes are compared on.
enum class Comparison {
  kImage,    // the whole image: position and scale count
  kCropped,  // both cropped to their boxes and scaled to a common size, as the thesis does: only the shape counts
};

struct SilhouetteOptions {
  Comparison comparison = Comparison::kImage;
  double sharpness = 40;  // log-likelihood of a silhouette at distance 1 is -sharpness
  int resolution = 128;   // raster pixels along the longer side of the observed silhouette
  // Errors: throws std::invalid_argument.
  void check() const;
};

class SilhouetteLikelihood final : public PoseLikelihood {
 public:
  // REQUIRES: at least one backend, all of the same body; a metric.
  SilhouetteLikelihood(std::vector<std::shared_ptr<const RenderBackend>> backends,
                       std::shared_ptr<const ShapeMetric> metric, SilhouetteOptions options);

  [[nodiscard]] const BodyModel& body() const override { return backends_.front()->body(); }

  // A camera whose observation found nothing is ignored. Ignored pixels do not count where whole images are compared;
  // cropped silhouettes have no common pixels to leave out.
  [[nodiscard]] std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const override;

  // -sharpness * trust * distance, summed over cameras.
  void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const override;

  // Distance of each state, mean over the cameras that are used. Shapes: states [N, D' >= D]; out [N].
  void distances(const Evidence& evidence, const StateBatch& states, std::span<double> out) const;

 private:
  struct View;
  struct Prepared;
  [[nodiscard]] View view_of(const Observation& observation, const PinholeCamera& camera) const;
  [[nodiscard]] Window window_of_comparison(const Box& box, const PinholeCamera& camera) const;
  // Sum over cameras of the distance, times the camera's trust when `weighted`.
  void accumulate(const Prepared& evidence, const StateBatch& states, bool weighted, std::span<double> out) const;
  void distances_of(size_t camera_idx, const View& view, const BatchView& poses, std::span<double> out) const;
  bool count(size_t camera_idx, const View& view, const BatchView& poses, std::span<double> out) const;

  std::vector<std::shared_ptr<const RenderBackend>> backends_;
  std::shared_ptr<const ShapeMetric> metric_;
  SilhouetteOptions options_;
};

}  // namespace silpose
