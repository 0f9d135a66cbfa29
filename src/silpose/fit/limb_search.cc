#include "silpose/fit/limb_search.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "silpose/base/parallel.h"

namespace silpose {

std::vector<LimbVariant> rank_limb_variants(const CoverageLikelihood& likelihood, const CoverageEvidence& evidence,
                                            std::span<const Limb> limbs, std::span<const double> pose,
                                            const Eigen::Vector3d& camera_centre, const LimbSearchOptions& options,
                                            Rng& rng) {
  const BodyModel& body = likelihood.body();
  std::vector<LimbVariant> variants =
      limb_variants(body, limbs, pose, camera_centre, options.num_random, options.two_at_once, rng);
  std::vector<double> energy(variants.size());
  parallel_for(variants.size(), 8, [&](size_t begin, size_t end) {
    CoverageLikelihood::Scratch scratch(likelihood);
    for (size_t v = begin; v < end; ++v) energy[v] = likelihood.energy(evidence, Blur::k4, variants[v].pose, scratch);
  });
  std::vector<size_t> order(variants.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t v) { return energy[v]; });

  std::vector<LimbVariant> kept;
  std::vector<std::vector<Eigen::Vector3d>> known = {landmark_positions(body, pose)};
  for (const size_t v : order) {
    if (std::ssize(kept) == options.num_kept) break;
    std::vector<Eigen::Vector3d> x = landmark_positions(body, variants[v].pose);
    const auto is_near = [&](const auto& other) { return furthest_apart(x, other) < options.novelty; };
    if (std::ranges::any_of(known, is_near)) continue;
    known.push_back(std::move(x));
    kept.push_back(std::move(variants[v]));
  }
  return kept;
}

}  // namespace silpose
