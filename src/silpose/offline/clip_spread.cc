#include "silpose/offline/clip_spread.h"

#include <algorithm>
#include <cmath>

#include "silpose/fit/pose_fit.h"

namespace silpose {
namespace {

constexpr double kLeastWeight = 1e-6;  // [guess] lighter ones are left out: they change no digit that matters

}  // namespace

std::vector<double> weights_beside(double smoothed, std::span<const double> energies, size_t num_passes) {
  double best = smoothed;
  for (const double energy : energies) best = std::min(best, energy);
  double sum = std::exp(-0.5 * (smoothed - best));
  std::vector<double> weights;
  for (const double energy : energies) {
    weights.push_back(std::exp(-0.5 * (energy - best)) / static_cast<double>(num_passes));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

void add_disagreement(const BodyModel& body, std::span<const double> smoothed, std::span<const Eigen::VectorXd> poses,
                      std::span<const double> weights, PoseVariances& sum) {
  const PoseScatter scatter(body, smoothed);
  for (size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] >= kLeastWeight) scatter.add(weights[k], view(poses[k]), sum);
  }
}

}  // namespace silpose
