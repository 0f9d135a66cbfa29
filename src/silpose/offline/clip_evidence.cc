#include "silpose/offline/clip_evidence.h"

#include "silpose/base/parallel.h"
#include "silpose/fit/pose_fit.h"

namespace silpose {

CoverageEvidence ClipEvidence::at(size_t t) const {
  CoverageEvidence evidence = likelihood.evidence_of(instants[t]->observations, kClipBlur, kClipBlur, kind);
  evidence.set_noise(noise);
  return evidence;
}

std::vector<std::vector<double>> energies_of(const ClipEvidence& evidence, std::span<const Hypotheses> hypotheses) {
  std::vector<std::vector<double>> energies(evidence.size());
  parallel_for(evidence.size(), 4, [&](size_t begin, size_t end) {
    CoverageLikelihood::Scratch scratch(evidence.likelihood);
    for (size_t t = begin; t < end; ++t) {
      const std::vector<Eigen::VectorXd>& poses = hypotheses[t].poses;
      energies[t].assign(poses.size(), 0.0);
      if (!evidence.seen[t]) continue;
      const CoverageEvidence seen = evidence.at(t);
      for (size_t k = 0; k < poses.size(); ++k) {
        energies[t][k] = evidence.likelihood.energy(seen, kClipBlur, view(poses[k]), scratch);
      }
    }
  });
  return energies;
}

}  // namespace silpose
