#include "silpose/synth/drawn_person.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/body/girth.h"
#include "silpose/body/stretchable.h"

namespace silpose {
namespace {

constexpr double kThinnest = -0.4;  // share of a girth: beyond, flesh would turn inside out

// Normal with this covariance; it may be singular.
std::vector<double> draw(const Eigen::MatrixXd& covariance, Rng& rng) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(covariance);
  Eigen::VectorXd factors = solved.eigenvalues().cwiseMax(0).cwiseSqrt();
  for (double& factor : factors) factor *= rng.normal();
  const Eigen::VectorXd drawn = solved.eigenvectors() * factors;
  return {drawn.begin(), drawn.end()};
}

}  // namespace

BodyModel draw_person(const BodyModel& body, uint64_t seed) {
  Rng rng(seed);
  const Girths girths(body);
  std::vector<double> thicker = draw(girths.covariance(), rng);
  for (double& share : thicker) share = std::max(share, kThinnest);
  const std::vector<double> longer = draw(stretch_covariance(stretchable(body).skeleton), rng);
  const BodyModel person = with_lengths(girths.applied(thicker), longer);
  return scaled(person, body.height_m / person.height_m);
}

}  // namespace silpose
