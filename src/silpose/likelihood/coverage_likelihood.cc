#include "silpose/likelihood/coverage_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/scratch_pool.h"
#include "silpose/likelihood/coverage_difference.h"
#include "silpose/likelihood/coverage_raster.h"
#include "silpose/likelihood/end_motion.h"
#include "silpose/render/outline_spans.h"
#include "silpose/render/projected_skin.h"

namespace silpose {
namespace {

// What turns sum_cells D (K * D) into squared pixels along the outline.
double outline_scale(int cell) {
  return 2 * std::sqrt(std::numbers::pi) * cell * static_cast<double>(cell) * static_cast<double>(cell);
}

// Degrees of freedom that a fit takes from an outline: the residual, which estimates the noise, no longer contains what
// they explain. [tuned on the walk and a dance: with 25, a lost dance stayed lost (docs/notebook/tracking.md)]
constexpr double kFittedNumbers = 15;

}  // namespace

struct CoverageLikelihood::Impl {
  struct View {
    View(const BodyModel& body, const PinholeCamera& camera)
        : skin(body, camera), topology(skin.faces()), lens(camera) {}
    ProjectedSkin skin;
    EdgeTopology topology;
    LensDerivative lens;
  };
  Impl(std::shared_ptr<const BodyModel> the_body, std::vector<PinholeCamera> the_cameras, int the_rows_per_cell,
       std::vector<std::shared_ptr<const PoseLikelihood>> the_terms)
      : body(std::move(the_body)),
        cameras(std::move(the_cameras)),
        rows_per_cell(the_rows_per_cell),
        terms(std::move(the_terms)) {
    views.reserve(cameras.size());
    for (const PinholeCamera& camera : cameras) views.emplace_back(*body, camera);
  }
  std::shared_ptr<const BodyModel> body;
  std::vector<PinholeCamera> cameras;
  std::vector<View> views;
  int rows_per_cell;
  std::vector<std::shared_ptr<const PoseLikelihood>> terms;

  mutable ScratchPool<Scratch::Impl> pool;
};

struct CoverageLikelihood::Scratch::Impl {
  explicit Impl(const CoverageLikelihood::Impl& likelihood) : end_motion(*likelihood.body) {
    for (const auto& view : likelihood.views) spans.emplace_back(view.topology);
  }
  ProjectedSkin::Scratch projected;
  std::vector<Eigen::Vector2f> pixels;  // [slots]
  std::vector<OutlineSpans> spans;      // [C]
  EndMotion end_motion;
  CoverageDifference difference;
};

CoverageLikelihood::Scratch::Scratch(const CoverageLikelihood& likelihood)
    : owner_(likelihood.impl_), impl_(owner_->pool.take(*owner_)) {}
CoverageLikelihood::Scratch::Scratch(Scratch&&) noexcept = default;
CoverageLikelihood::Scratch::~Scratch() {
  if (impl_) owner_->pool.give_back(std::move(impl_));  // not moved from
}

CoverageLikelihood::CoverageLikelihood(std::shared_ptr<const BodyModel> body, std::vector<PinholeCamera> cameras,
                                       int rows_per_cell, std::vector<std::shared_ptr<const PoseLikelihood>> terms) {
  check(rows_per_cell >= 1, "CoverageLikelihood: {} rows per cell", rows_per_cell);
  check(body != nullptr && !body->rest.faces.empty(), "CoverageLikelihood: no body");
  check(!cameras.empty(), "CoverageLikelihood: no camera");
  for (const auto& term : terms) {
    check(term != nullptr && term->can_linearise(), "CoverageLikelihood: a term that cannot be linearised");
    check(term->body().skeleton.num_dofs() == body->skeleton.num_dofs(),
          "CoverageLikelihood: a term of {} DOF for a body of {}", term->body().skeleton.num_dofs(),
          body->skeleton.num_dofs());
  }
  impl_ = std::make_shared<const Impl>(std::move(body), std::move(cameras), rows_per_cell, std::move(terms));
}
CoverageLikelihood::~CoverageLikelihood() = default;

const BodyModel& CoverageLikelihood::body() const { return *impl_->body; }
std::span<const PinholeCamera> CoverageLikelihood::cameras() const { return impl_->cameras; }

CoverageEvidence CoverageLikelihood::evidence_of(std::span<const Observation> observations, Blur widest, Blur narrowest,
                                                 EvidenceKind kind) const {
  check_number(observations, cameras().size());
  CoverageEvidence evidence;
  evidence.silhouettes = kind != EvidenceKind::kKeypoints;
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& observation = observations[c];
    const PinholeCamera& camera = cameras()[c];
    check_fits(observation, camera);
    CoverageEvidence::View& view = evidence.views.emplace_back();
    evidence.noise.push_back(0);
    const Box box = observation.box();
    if (observation.trust.nothing_found || box.empty()) continue;
    view.trust = observation.trust.overall;
    view.keypoints = make_keypoint_term(body(), camera, observation, kind);
    const double extent = std::max(box.height, box.width);
    view.pixel_unit = std::max(extent / CoverageEvidence::kSubjectHeight, 0.25);
    view.outline_length = outline_length(observation);
    evidence.noise.back() = kExactNoise * std::pow(view.pixel_unit, 3);
    for (auto b = static_cast<size_t>(narrowest); b <= static_cast<size_t>(widest); ++b) {
      const int cell = std::max(1, static_cast<int>(std::lround(kBlurSigma[b] * view.pixel_unit)));
      view.rasters[b] = coverage_raster(observation, cell);
    }
  }
  for (const auto& term : impl_->terms) evidence.terms.push_back({term, term->prepare(observations)});
  return evidence;
}

std::unique_ptr<const PoseLikelihood::Evidence> CoverageLikelihood::prepare(
    std::span<const Observation> observations) const {
  return std::make_unique<CoverageEvidence>(evidence_of(observations, kRankingBlur, kRankingBlur, EvidenceKind::kBoth));
}

void CoverageLikelihood::add_log_likelihood(const Evidence& evidence, const StateBatch& states,
                                            std::span<double> out) const {
  constexpr size_t kGrain = 8;  // [guess] poses per task
  check_batch(body(), states, out);
  const auto& own = own_evidence<CoverageEvidence>(evidence);
  const auto num_dofs = static_cast<size_t>(body().skeleton.num_dofs());
  parallel_for(out.size(), kGrain, [&](size_t begin, size_t end) {
    Scratch scratch(*this);
    for (size_t n = begin; n < end; ++n) {
      const std::span pose(states.row(static_cast<Eigen::Index>(n)).data(), num_dofs);
      out[n] -= 0.5 * energy(own, kRankingBlur, pose, scratch);
    }
  });
}

NormalEquations CoverageLikelihood::linearise(const Evidence& evidence, std::span<const double> pose) const {
  Scratch scratch(*this);
  return linearise(own_evidence<CoverageEvidence>(evidence), kRankingBlur, pose, scratch);
}

namespace {

// Errors: throws std::invalid_argument for a blur that was not prepared.
const CoverageEvidence::Raster& raster_of(const CoverageEvidence::View& view, Blur blur) {
  const CoverageEvidence::Raster& raster = view.rasters[static_cast<size_t>(blur)];
  check(raster.cell > 0, "CoverageLikelihood: evidence without a blur of {}", kBlurSigma[static_cast<size_t>(blur)]);
  return raster;
}

SampledRows rows_of(const PinholeCamera& camera, int cell, int rows_per_cell) {
  const float step = static_cast<float>(cell) / static_cast<float>(rows_per_cell);
  return {
      .first = step / 2, .step = step, .count = static_cast<int>(std::floor(static_cast<float>(camera.height) / step))};
}

}  // namespace

// Draws the difference seen by one camera; false where the body is not seen.
bool CoverageLikelihood::draw(size_t camera_idx, const CoverageEvidence::Raster& raster, std::span<const double> pose,
                              Scratch::Impl& s) const {
  const ProjectedSkin& skin = impl_->views[camera_idx].skin;
  const PinholeCamera& camera = impl_->cameras[camera_idx];
  s.difference.start(raster, camera.width, impl_->rows_per_cell);
  s.pixels.resize(skin.num_slots());
  if (!skin.project_to_pixels(pose, s.pixels, s.projected)) return false;
  s.spans[camera_idx].scan(s.pixels, rows_of(camera, raster.cell, impl_->rows_per_cell), s.projected.some_unseen);
  s.difference.add_model(s.spans[camera_idx].ends());
  return true;
}

std::vector<double> CoverageLikelihood::residuals(const CoverageEvidence& evidence, Blur blur,
                                                  std::span<const double> pose, Scratch& scratch) const {
  check(evidence.views.size() == impl_->views.size(), "CoverageLikelihood: evidence of {} cameras for {}",
        evidence.views.size(), impl_->views.size());
  Scratch::Impl& s = *scratch.impl_;
  std::vector<double> residual(impl_->views.size(), 0.0);
  for (size_t c = 0; c < impl_->views.size(); ++c) {
    const CoverageEvidence::View& evident = evidence.views[c];
    if (evident.trust <= 0) continue;
    const CoverageEvidence::Raster& raster = raster_of(evident, blur);
    (void)draw(c, raster, pose, s);
    residual[c] = outline_scale(raster.cell) * s.difference.finish();
  }
  return residual;
}

double CoverageLikelihood::energy(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                  Scratch& scratch) const {
  double sum = evidence.keypoint_cost(impl_->body->skeleton, pose) + evidence.energy_of_terms(pose);
  if (!evidence.silhouettes) return sum;
  const std::vector<double> residual = residuals(evidence, blur, pose, scratch);
  for (size_t c = 0; c < residual.size(); ++c) {
    if (residual[c] > 0) sum += evidence.views[c].trust / evidence.noise[c] * residual[c];
  }
  return sum;
}

NormalEquations CoverageLikelihood::linearise(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                              Scratch& scratch) const {
  check(evidence.views.size() == impl_->views.size(), "CoverageLikelihood: evidence of {} cameras for {}",
        evidence.views.size(), impl_->views.size());
  Scratch::Impl& s = *scratch.impl_;
  const Eigen::Index D = impl_->body->skeleton.num_dofs();
  NormalEquations equations{0, Eigen::VectorXd::Zero(D), Eigen::MatrixXd::Zero(D, D)};
  for (size_t c = 0; c < impl_->views.size(); ++c) {
    const CoverageEvidence::View& evident = evidence.views[c];
    if (evident.trust <= 0) continue;
    if (evident.keypoints) {
      equations.energy +=
          evident.keypoints->add(impl_->body->skeleton, pose, evident.trust, equations.gradient, equations.hessian);
    }
    if (!evidence.silhouettes) continue;
    const Impl::View& view = impl_->views[c];
    const CoverageEvidence::Raster& raster = raster_of(evident, blur);
    if (draw(c, raster, pose, s)) {
      const float step = static_cast<float>(raster.cell) / static_cast<float>(impl_->rows_per_cell);
      const float by = step / (static_cast<float>(raster.cell) * static_cast<float>(raster.cell));
      s.end_motion.set_pose(pose, s.projected.world_from_joint, impl_->cameras[c].cam_from_world);
      s.end_motion.fill_jacobian(s.spans[c], view.skin.vertex_of_slot(), view.lens, by, s.difference);
    }
    const double weight = evident.trust / evidence.noise[c] * outline_scale(raster.cell);
    equations.energy += weight * s.difference.finish();
    s.difference.add_normal_equations(weight, s.end_motion.columns(), equations.gradient, equations.hessian);
  }
  equations.energy += evidence.add_terms(pose, equations.gradient, equations.hessian);
  return equations;
}

std::vector<double> CoverageLikelihood::estimate_noise(const CoverageEvidence& evidence, std::span<const double> pose,
                                                       Scratch& scratch) const {
  std::vector<double> noise = residuals(evidence, Blur::k8, pose, scratch);
  for (size_t c = 0; c < noise.size(); ++c) {
    const CoverageEvidence::View& view = evidence.views[c];
    if (view.trust <= 0 || view.outline_length <= 0) {
      noise[c] = 0;
      continue;
    }
    const double along = 2 * std::sqrt(std::numbers::pi) * view.rasters[static_cast<size_t>(Blur::k8)].cell;
    const double segments = view.outline_length / along;
    const double left = std::max(segments - kFittedNumbers, 0.25 * segments) / segments;
    noise[c] *= along / (view.outline_length * left) / std::pow(view.pixel_unit, 3);
    noise[c] = std::max(noise[c], kLeastNoise);
  }
  return noise;
}

std::vector<double> CoverageLikelihood::least_noise(const CoverageEvidence& evidence,
                                                    std::span<const Eigen::VectorXd> poses, Scratch& scratch) const {
  std::vector<double> least;
  for (const Eigen::VectorXd& pose : poses) {
    const std::vector<double> noise =
        estimate_noise(evidence, {pose.data(), static_cast<size_t>(pose.size())}, scratch);
    if (least.empty()) least = noise;
    for (size_t c = 0; c < noise.size(); ++c) least[c] = std::min(least[c], noise[c]);
  }
  return least;
}

}  // namespace silpose
