// Resampling: which particles survive. Every scheme has one signature:
//
//   log_weight [N]   need not be normalised; minus infinity is weight zero; all minus infinity counts as uniform.
//   num_samples M    how many particles to make; M may differ from N.
//   rng              the stream of this step's resampling.
//   returns [M]      ancestor indices into [0, N), in no promised order, or kRegenerate: a particle to be regenerated.
//
// A scheme is unbiased when index i comes up M * w_i times on average. A particle of weight zero never comes up unless
// all are zero. Which to choose:
//
//   systematic   unbiased, and each count within one of M * w_i; the default.
//   comb         sorts by weight, has the lowest share of the particles regenerated and combs over the others: thesis
//                Fig. 2.26. Biased, but finds lost subjects again. With a share of 0 it is systematic on sorted
//                weights.
//
// Based on: Salmond & Gordon 2005, Li et al. 2015 (references.bib: salmond2005, li2015, cormier2019).
// Threads: resamplers are constant; any thread may call.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/base/rng.h"

namespace silpose {

inline constexpr int kRegenerate = -1;  // [definition]

class Resampler {
 public:
  virtual ~Resampler() = default;

  // The contract is on top. Errors: throws std::invalid_argument for N = 0, M < 1, NaN or plus infinity.
  [[nodiscard]] virtual std::vector<int> resample(std::span<const double> log_weight, int num_samples,
                                                  Rng& rng) const = 0;
};

// The names that make_resampler() knows.
std::span<const std::string_view> resampler_names();

// `regenerate_fraction`, in [0, 1), is comb's share of particles to be regenerated.
// Errors: an unknown name; the fraction is out of range.
Result<std::unique_ptr<Resampler>> make_resampler(const std::string& name, double regenerate_fraction = 0.2);

}  // namespace silpose
