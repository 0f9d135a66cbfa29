#include <memory>
#include <string>
#include <vector>

#include "benches.h"
#include "silhouette_scene.h"
#include "silpose/base/rng.h"
#include "silpose/body/body_model.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/likelihood/coverage_reference.h"
#include "silpose/render/silhouette.h"

namespace silpose::bench {
namespace {

constexpr Blur kBlur = Blur::k4;
constexpr size_t kCases = 8;

// A silhouette to fit to, and a pose on the way there.
struct Case {
  CoverageEvidence evidence;
  std::vector<double> pose;
};

// Standing poses that use a sixth of every angle's range; fits that are some centimetres off.
std::vector<Case> make_cases(const CoverageLikelihood& likelihood) {
  Rng rng(1);
  const BodyModel& body = likelihood.body();
  const std::vector<double> standing = standing_pose(body);
  std::vector<Case> cases;
  for (size_t n = 0; n < kCases; ++n) {
    std::vector<double> truth = standing, pose = standing;
    for (size_t d = 0; d < standing.size(); ++d) {
      const Dof& dof = body.skeleton.dofs()[d];
      truth[d] += (dof.is_translation ? 0.3 : (dof.upper - dof.lower) / 6) * rng.uniform(-0.5, 0.5);
      pose[d] = truth[d] + (dof.is_translation ? 0.03 : 0.1) * rng.uniform(-0.5, 0.5);
    }
    Observation observation;
    observation.mask = render_silhouette(body, likelihood.cameras()[0], truth);
    cases.push_back({likelihood.evidence_of(std::vector{observation}, kBlur, kBlur), std::move(pose)});
  }
  return cases;
}

// `step(case)` in microseconds, next to the reference, which gets one case a round.
template <class Step>
Figure fit_figure(const CoverageLikelihood& likelihood, const std::vector<Case>& cases, int repeats, int rounds,
                  const Step& step) {
  size_t next = 0;
  const Contestant ours{.name = "ours", .amount = 1e-6 * static_cast<double>(repeats) * kCases, .run = [&] {
                          for (int i = 0; i < repeats; ++i) {
                            for (const Case& at : cases) step(at);
                          }
                        }};
  const Contestant plain{
      .name = "plain reference in double precision", .amount = 1e-6, .run = [&] {
        const Case& at = cases[next++ % kCases];
        keep(linearise_reference(likelihood.body(), likelihood.cameras(), at.evidence, kBlur, at.pose));
      }};
  return measure({.unit = "us", .higher_is_better = false, .rounds = rounds}, ours, {&plain, 1});
}

Figure fit_step(std::shared_ptr<const BodyModel> body, int repeats, int rounds) {
  const CoverageLikelihood likelihood(std::move(body), {default_camera(640, 480)});
  CoverageLikelihood::Scratch scratch(likelihood);
  const std::vector<Case> cases = make_cases(likelihood);
  for (size_t n = 0; n < kCases; ++n) {
    const Case& at = cases[n];
    const NormalEquations ours = likelihood.linearise(at.evidence, kBlur, at.pose, scratch);
    const NormalEquations theirs =
        linearise_reference(likelihood.body(), likelihood.cameras(), at.evidence, kBlur, at.pose);
    const std::string which = " of case " + std::to_string(n);
    verify(theirs.energy > 10, "the energy is too small to be of a pose that is off" + which);
    verify(std::abs(ours.energy - theirs.energy) <= 1e-3 * theirs.energy, "energy" + which);
    verify((ours.gradient - theirs.gradient).norm() <= 1e-3 * theirs.gradient.norm(), "gradient" + which);
    // Wider: an end on an edge that hardly crosses a row magnifies the rounding of its vertices.
    verify((ours.hessian - theirs.hessian).norm() <= 1e-2 * theirs.hessian.norm(), "Hessian" + which);
  }
  return fit_figure(likelihood, cases, repeats, rounds,
                    [&](const Case& at) { keep(likelihood.linearise(at.evidence, kBlur, at.pose, scratch)); });
}

}  // namespace

Figure fit_step_us(int rounds) { return fit_step(level_of_detail(human(), 2500), 20, rounds); }
Figure fit_step_full_us(int rounds) { return fit_step(human(), 10, rounds); }

Figure fit_energy_us(int rounds) {
  const CoverageLikelihood likelihood(level_of_detail(human(), 2500), {default_camera(640, 480)});
  CoverageLikelihood::Scratch scratch(likelihood);
  const std::vector<Case> cases = make_cases(likelihood);
  for (size_t n = 0; n < kCases; ++n) {
    const Case& at = cases[n];
    const double theirs =
        linearise_reference(likelihood.body(), likelihood.cameras(), at.evidence, kBlur, at.pose).energy;
    verify(std::abs(likelihood.energy(at.evidence, kBlur, at.pose, scratch) - theirs) <= 1e-3 * theirs,
           "energy of case " + std::to_string(n));
  }
  return fit_figure(likelihood, cases, 40, rounds,
                    [&](const Case& at) { keep(likelihood.energy(at.evidence, kBlur, at.pose, scratch)); });
}

}  // namespace silpose::bench
