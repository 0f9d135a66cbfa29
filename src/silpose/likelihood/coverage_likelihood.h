// CoverageLikelihood: a silhouette likelihood that has a derivative. Model and observation are compared by how much of
// each cell of a grid they cover, after a blur as wide as a cell: the wider the blur, the further off a pose may be and
// still be pulled the right way. No correspondences are needed, and missing model area pulls as much as excess model
// area.
//
//   E(pose) = sum over cameras of trust / noise * 2 sqrt(pi) sigma c^2 sum_cells (G_sigma * w (C_model - C_observed))^2
//
// with cells of side c = sigma, C the covered part of a cell, w its confidence. A straight outline of length L that is
// d pixels off has E = L d^2 / noise at every sigma, so `noise` is the variance of the outline times its correlation
// length along the outline (px^3) and E counts independent errors: -2 log-likelihood.
// The derivative is exact for the sampled rows: each end of a span moves by dx = J_x - (dx/dy) J_y of the surface point
// there. Blurring is done once and on both sides: G * G is one kernel, wanted only at the cells that hold an end.
// Where a network found keypoints, their cost (keypoint_term.h) is added to E, and so are further terms that are given,
// so that fitting, ranking and weighing poses by E use all kinds of evidence. As a PoseLikelihood it uses all of them,
// at kRankingBlur and the noise of exact masks.
// Based on: Gauss-Newton on smooth image differences (references.bib: nocedal2006).
// Threads: constant after construction; one Scratch per thread.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"
#include "silpose/likelihood/coverage_evidence.h"
#include "silpose/likelihood/keypoint_term.h"
#include "silpose/likelihood/pose_likelihood.h"

namespace silpose {

// Rows of the model that are sampled per cell, in fits.
inline constexpr int kFittingRows = 2;  // [guess]

class CoverageLikelihood final : public PoseLikelihood {
  struct Impl;

 public:
  // `rows_per_cell`: how finely the model's coverage is sampled; more make E smoother, and slower. `terms`: further
  // evidence. Errors: throws std::invalid_argument without body or camera, and for a term that cannot be linearised or
  // is of a body with other degrees of freedom.
  CoverageLikelihood(std::shared_ptr<const BodyModel> body, std::vector<PinholeCamera> cameras,
                     int rows_per_cell = kFittingRows, std::vector<std::shared_ptr<const PoseLikelihood>> terms = {});
  ~CoverageLikelihood() override;

  // The noise of exact masks, in units of pixel_unit^3: the default of CoverageEvidence::noise.
  static constexpr double kExactNoise = 10;
  // Outlines are never trusted further than this, however well a body may fit: its skin has its own errors.
  static constexpr double kLeastNoise = 1;
  // By which candidates are ranked. [guess]
  static constexpr Blur kRankingBlur = Blur::k4;

  // Shapes: one observation per camera. A camera whose observation found nothing is ignored. Only blurs from
  // `narrowest` to `widest` are prepared. Errors: throws std::invalid_argument where a mask or confidence does not fit
  // its camera.
  [[nodiscard]] CoverageEvidence evidence_of(std::span<const Observation> observations, Blur widest = Blur::k32,
                                             Blur narrowest = Blur::k2,
                                             EvidenceKind kind = EvidenceKind::kSilhouette) const;

  // Working memory of evaluations, one per thread. It returns to its likelihood at the end, for reuse: cheap to make.
  class Scratch {
   public:
    explicit Scratch(const CoverageLikelihood& likelihood);
    Scratch(Scratch&&) noexcept;
    ~Scratch();

   private:
    friend class CoverageLikelihood;
    struct Impl;
    std::shared_ptr<const CoverageLikelihood::Impl> owner_;
    std::unique_ptr<Impl> impl_;
  };

  // E of a pose [D]. A body that is not seen covers nothing.
  double energy(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose, Scratch& scratch) const;

  NormalEquations linearise(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                            Scratch& scratch) const;

  // E of each view by itself with noise 1 and trust 1 (px^3): what noise is estimated from. [C]
  std::vector<double> residuals(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                Scratch& scratch) const;

  // The noise of the outlines, estimated at a pose that fits: variance times correlation length, in units of
  // pixel_unit^3, never below kLeastNoise. White noise of variance s^2 and correlation length l leaves
  // s^2 l L / (2 sqrt(pi) sigma) after a blur wider than l, of which a fit explains some. A camera that is ignored: 0.
  // [C]
  std::vector<double> estimate_noise(const CoverageEvidence& evidence, std::span<const double> pose,
                                     Scratch& scratch) const;

  // The least noise that one of several poses leaves, camera by camera: the best of them shows how good a fit can be.
  // Shapes: [K] of [D] -> [C].
  std::vector<double> least_noise(const CoverageEvidence& evidence, std::span<const Eigen::VectorXd> poses,
                                  Scratch& scratch) const;

  [[nodiscard]] const BodyModel& body() const override;
  [[nodiscard]] std::span<const PinholeCamera> cameras() const;

  // As PoseLikelihood. Keypoints count where there are some.
  [[nodiscard]] std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const override;
  void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const override;
  [[nodiscard]] bool can_linearise() const override { return true; }
  [[nodiscard]] NormalEquations linearise(const Evidence& evidence, std::span<const double> pose) const override;

 private:
  bool draw(size_t camera_idx, const CoverageEvidence::Raster& raster, std::span<const double> pose,
            Scratch::Impl& s) const;

  std::shared_ptr<const Impl> impl_;
};

}  // namespace silpose
