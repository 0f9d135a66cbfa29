// ClipEvidence: what the poses of a clip that was tracked are compared with: its observations at a narrow blur, with
// the noise of its outlines as it was found.
// Threads: constant after construction.
#pragma once

#include <span>
#include <vector>

#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/offline/clip_hypotheses.h"
#include "silpose/offline/clip_instant.h"

namespace silpose {

struct ClipEvidence {
  const CoverageLikelihood& likelihood;
  std::span<const ClipInstant* const> instants;  // [T]
  std::vector<bool> seen;                        // [T] false: nothing usable
  EvidenceKind kind = EvidenceKind::kSilhouette;
  std::vector<double> noise;  // [C] units of pixel_unit^3; empty: that of exact masks

  [[nodiscard]] size_t size() const { return instants.size(); }
  // Of instant t, prepared at kClipBlur.
  [[nodiscard]] CoverageEvidence at(size_t t) const;
};

inline constexpr Blur kClipBlur = Blur::k4;

// Energies [T][K] of the hypotheses [T] of all instants; 0 where nothing is seen. Uses all cores.
std::vector<std::vector<double>> energies_of(const ClipEvidence& evidence, std::span<const Hypotheses> hypotheses);

}  // namespace silpose
