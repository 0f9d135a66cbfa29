// DepthLikelihood: how well poses explain the depth that cameras measured on the subject: the normalised sum of squared
// differences of depth images. Observations without depth add nothing; ignored pixels, and those of the mask without
// depth, do not count.
// Source: cormier2019 eq. 2.12 (references.bib).
// Threads: as PoseLikelihood.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/likelihood/pose_likelihood.h"
#include "silpose/render/render_backend.h"

namespace silpose {

struct DepthOptions {
  double sharpness = 40;   // log-likelihood of a pose that shows nothing is -sharpness
  double missing_m = 0.3;  // [guess] a surface in one of both images only counts like one that is so far off
  int resolution = 64;     // raster pixels along the longer side of the observed silhouette
  // Errors: throws std::invalid_argument.
  void check() const;
};

class DepthLikelihood final : public PoseLikelihood {
 public:
  // REQUIRES: at least one backend, all of the same body.
  DepthLikelihood(std::vector<std::shared_ptr<const RenderBackend>> backends, DepthOptions options);

  [[nodiscard]] const BodyModel& body() const override { return backends_.front()->body(); }
  [[nodiscard]] std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const override;
  // -sharpness * trust * SSD / (observed pixels * missing_m^2), summed over cameras.
  void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const override;

 private:
  struct Prepared;
  std::vector<std::shared_ptr<const RenderBackend>> backends_;
  DepthOptions options_;
};

}  // namespace silpose
