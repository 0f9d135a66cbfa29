#include "silpose/filter/resampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/filter/log_weights.h"

namespace silpose {
namespace {

// One comb of num_samples evenly spaced teeth, shifted at random, over the weights laid end to end in `order`.
void comb(std::span<const double> weight, std::span<const int> order, int num_samples, Rng& rng,
          std::vector<int>& ancestors) {
  double total = 0;
  for (const int i : order) total += weight[static_cast<size_t>(i)];
  const double spacing = total / num_samples;
  const double shift = rng.uniform() * spacing;
  double reached = 0;
  size_t at = 0;
  size_t last_alive = 0;  // rounding may let the last teeth pass the end: they belong to the last particle with weight
  int taken = 0;
  for (; at < order.size() && taken < num_samples; ++at) {
    const double w = weight[static_cast<size_t>(order[at])];
    if (w <= 0) continue;
    last_alive = at;
    reached += w;
    for (; taken < num_samples && shift + taken * spacing < reached; ++taken) ancestors.push_back(order[at]);
  }
  for (; taken < num_samples; ++taken) ancestors.push_back(order[last_alive]);
}

void check_input(std::span<const double> log_weight, int num_samples) {
  check(!log_weight.empty(), "resample: no particles");
  check(num_samples >= 1, "resample: {} samples", num_samples);
}

class SystematicResampler final : public Resampler {
 public:
  std::vector<int> resample(std::span<const double> log_weight, int num_samples, Rng& rng) const override {
    check_input(log_weight, num_samples);
    const std::vector<double> weight = weights_from_log_weights(log_weight);
    std::vector<int> order(weight.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<int> ancestors;
    ancestors.reserve(static_cast<size_t>(num_samples));
    comb(weight, order, num_samples, rng, ancestors);
    return ancestors;
  }
};

class CombResampler final : public Resampler {
 public:
  explicit CombResampler(double regenerate_fraction) : regenerate_fraction_(regenerate_fraction) {}

  std::vector<int> resample(std::span<const double> log_weight, int num_samples, Rng& rng) const override {
    check_input(log_weight, num_samples);
    const std::vector<double> weight = weights_from_log_weights(log_weight);
    std::vector<int> order(weight.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return weight[static_cast<size_t>(a)] < weight[static_cast<size_t>(b)]; });
    // At least the best particle is combed over, and gets a tooth, whatever the rounding.
    const auto share = [&](size_t count) {
      return std::min(count - 1, static_cast<size_t>(std::lround(regenerate_fraction_ * static_cast<double>(count))));
    };
    const size_t num_dropped = share(order.size());
    const size_t num_regenerated = share(static_cast<size_t>(num_samples));
    std::vector<int> ancestors(num_regenerated, kRegenerate);
    ancestors.reserve(static_cast<size_t>(num_samples));
    comb(weight, std::span(order).subspan(num_dropped), num_samples - static_cast<int>(num_regenerated), rng,
         ancestors);
    return ancestors;
  }

 private:
  double regenerate_fraction_;
};

struct NamedResampler {
  std::string_view name;
  std::unique_ptr<Resampler> (*make)(double regenerate_fraction);
};

constexpr std::array kResamplers = {NamedResampler{"comb",
                                                   [](double fraction) -> std::unique_ptr<Resampler> {
                                                     return std::make_unique<CombResampler>(fraction);
                                                   }},
                                    NamedResampler{"systematic", [](double) -> std::unique_ptr<Resampler> {
                                                     return std::make_unique<SystematicResampler>();
                                                   }}};
constexpr auto kNames = [] {
  std::array<std::string_view, kResamplers.size()> names;
  for (size_t i = 0; i < names.size(); ++i) names[i] = kResamplers[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> resampler_names() { return kNames; }

Result<std::unique_ptr<Resampler>> make_resampler(const std::string& name, double regenerate_fraction) {
  if (!(regenerate_fraction >= 0 && regenerate_fraction < 1)) {
    return error("regenerated fraction {}: must be at least 0 and below 1", regenerate_fraction);
  }
  const auto resampler = std::ranges::find(kResamplers, name, &NamedResampler::name);
  if (resampler == kResamplers.end()) return error("resampling '{}': not one of {}", name, fmt::join(kNames, ", "));
  return resampler->make(regenerate_fraction);
}

}  // namespace silpose
