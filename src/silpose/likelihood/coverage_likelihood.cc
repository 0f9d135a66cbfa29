#include "silpose/likelihood/coverage_likelihood.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/body/skin_derivative.h"
#include "silpose/likelihood/coverage_difference.h"
#include "silpose/likelihood/coverage_kernels.h"
#include "silpose/likelihood/coverage_raster.h"
#include "silpose/render/outline_spans.h"
#include "silpose/render/projected_skin.h"

namespace silpose {
namespace {

// Numbers that a fit takes from an outline: what they explain is not left in the residual.
constexpr double kFittedNumbers = 15;

// What turns sum_cells D (K * D) into squared pixels along the outline.
double outline_scale(int cell) {
  return 2 * std::sqrt(std::numbers::pi) * cell * static_cast<double>(cell) * static_cast<double>(cell);
}

// d pixel / d x_in_cam.
class LensDerivative {
 public:
  explicit LensDerivative(const PinholeCamera& camera)
      : lens_(camera),
        straight_(!camera.has_distortion()),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)) {
    lens_.cam_from_world = {};
  }

  [[nodiscard]] Eigen::Matrix<float, 2, 3> at(const Eigen::Vector3f& x_in_cam) const {
    if (!straight_) return lens_.project_jacobian(x_in_cam.cast<double>()).cast<float>();
    const float inverse_depth = 1 / x_in_cam.z();
    const float u = fx_ * inverse_depth, v = fy_ * inverse_depth;
    Eigen::Matrix<float, 2, 3> jacobian;
    jacobian << u, 0, -u * x_in_cam.x() * inverse_depth, 0, v, -v * x_in_cam.y() * inverse_depth;
    return jacobian;
  }

 private:
  PinholeCamera lens_;  // at the origin
  bool straight_;
  float fx_, fy_;
};

}  // namespace

struct CoverageLikelihood::Impl {
  struct View {
    View(const BodyModel& body, const PinholeCamera& camera)
        : skin(body, camera), topology(skin.faces()), lens(camera) {}
    ProjectedSkin skin;
    EdgeTopology topology;
    LensDerivative lens;
  };
  Impl(std::shared_ptr<const BodyModel> the_body, std::vector<PinholeCamera> the_cameras, int the_rows_per_cell)
      : body(std::move(the_body)), cameras(std::move(the_cameras)), rows_per_cell(the_rows_per_cell) {
    views.reserve(cameras.size());
    for (const PinholeCamera& camera : cameras) views.emplace_back(*body, camera);
  }
  std::shared_ptr<const BodyModel> body;
  std::vector<PinholeCamera> cameras;
  std::vector<View> views;
  int rows_per_cell;

  mutable std::mutex idle_mutex;
  mutable std::vector<std::unique_ptr<Scratch::Impl>> idle;  // nobody works in them now
};

struct CoverageLikelihood::Scratch::Impl {
  explicit Impl(const CoverageLikelihood::Impl& likelihood)
      : skin_derivative(*likelihood.body), point_of_vertex(likelihood.body->rest.vertices.size(), kNone) {
    for (const auto& view : likelihood.views) spans.emplace_back(view.topology);
  }
  ProjectedSkin::Scratch projected;
  std::vector<Eigen::Vector2f> pixels;  // [slots]
  std::vector<OutlineSpans> spans;      // [C]
  SkinDerivative skin_derivative;
  CoverageDifference difference;
  std::vector<EndRow> ends;

  // Vertices that ends lie between, each once.
  static constexpr uint32_t kNone = 0xffffffff;
  std::vector<uint32_t> point_of_vertex;  // [V] kNone for most
  std::vector<uint32_t> points;           // their vertices
  std::vector<Eigen::Matrix<float, 2, 3>> projections;
  AlignedFloats point_rows;

  uint32_t point_of(uint32_t vertex);
};

uint32_t CoverageLikelihood::Scratch::Impl::point_of(uint32_t vertex) {
  uint32_t& point = point_of_vertex[vertex];
  if (point == kNone) {
    point = static_cast<uint32_t>(points.size());
    points.push_back(vertex);
    skin_derivative.prefetch(vertex);
  }
  return point;
}

CoverageLikelihood::Scratch::Scratch(const CoverageLikelihood& likelihood) : owner_(likelihood.impl_) {
  {
    const std::scoped_lock lock(owner_->idle_mutex);
    if (!owner_->idle.empty()) {
      impl_ = std::move(owner_->idle.back());
      owner_->idle.pop_back();
    }
  }
  if (!impl_) impl_ = std::make_unique<Impl>(*owner_);
}
CoverageLikelihood::Scratch::Scratch(Scratch&&) noexcept = default;
CoverageLikelihood::Scratch::~Scratch() {
  if (!impl_) return;  // moved from
  const std::scoped_lock lock(owner_->idle_mutex);
  owner_->idle.push_back(std::move(impl_));
}

CoverageLikelihood::CoverageLikelihood(std::shared_ptr<const BodyModel> body, std::vector<PinholeCamera> cameras,
                                       int rows_per_cell) {
  check(rows_per_cell >= 1, "CoverageLikelihood: {} rows a cell", rows_per_cell);
  check(body != nullptr && !body->rest.faces.empty(), "CoverageLikelihood: no body");
  check(!cameras.empty(), "CoverageLikelihood: no camera");
  impl_ = std::make_shared<const Impl>(std::move(body), std::move(cameras), rows_per_cell);
}
CoverageLikelihood::~CoverageLikelihood() = default;

const BodyModel& CoverageLikelihood::body() const { return *impl_->body; }
std::span<const PinholeCamera> CoverageLikelihood::cameras() const { return impl_->cameras; }

void CoverageEvidence::set_noise(std::span<const double> relative) {
  for (size_t c = 0; c < relative.size(); ++c) {
    if (relative[c] > 0) noise[c] = relative[c] * std::pow(views[c].pixel_unit, 3);
  }
}

double CoverageEvidence::relative_noise(size_t camera_idx) const {
  return noise[camera_idx] / std::pow(views[camera_idx].pixel_unit, 3);
}

std::optional<size_t> CoverageEvidence::first_seen() const {
  const auto seen = std::ranges::find_if(views, [](const View& view) { return view.trust > 0; });
  return seen == views.end() ? std::nullopt : std::optional(static_cast<size_t>(seen - views.begin()));
}

CoverageEvidence CoverageLikelihood::prepare(std::span<const Observation> observations, Blur widest,
                                             Blur narrowest) const {
  check(observations.size() == impl_->cameras.size(), "CoverageLikelihood: {} observations for {} cameras",
        observations.size(), impl_->cameras.size());
  CoverageEvidence evidence;
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& observation = observations[c];
    const PinholeCamera& camera = impl_->cameras[c];
    check(observation.mask.width() == camera.width && observation.mask.height() == camera.height,
          "CoverageLikelihood: mask of {}x{} for camera '{}' of {}x{}", observation.mask.width(),
          observation.mask.height(), camera.name, camera.width, camera.height);
    CoverageEvidence::View& view = evidence.views.emplace_back();
    evidence.noise.push_back(0);
    if (observation.trust.nothing_found || observation.box.empty()) continue;
    view.trust = observation.trust.overall;
    const double extent = std::max(observation.box.height, observation.box.width);
    view.pixel_unit = std::max(extent / CoverageEvidence::kSubjectHeight, 0.25);
    view.outline_length = outline_length(observation.mask);
    evidence.noise.back() = kExactNoise * std::pow(view.pixel_unit, 3);
    for (auto b = static_cast<size_t>(narrowest); b <= static_cast<size_t>(widest); ++b) {
      const int cell = std::max(1, static_cast<int>(std::lround(kBlurSigma[b] * view.pixel_unit)));
      view.rasters[b] = coverage_raster(observation, cell);
    }
  }
  return evidence;
}

namespace {

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
    const CoverageEvidence::Raster& raster = evident.rasters[static_cast<size_t>(blur)];
    (void)draw(c, raster, pose, s);
    residual[c] = outline_scale(raster.cell) * s.difference.finish();
  }
  return residual;
}

double CoverageLikelihood::energy(const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                  Scratch& scratch) const {
  const std::vector<double> residual = residuals(evidence, blur, pose, scratch);
  double sum = 0;
  for (size_t c = 0; c < residual.size(); ++c) {
    if (residual[c] > 0) sum += evidence.views[c].trust / evidence.noise[c] * residual[c];
  }
  return sum;
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
    const Impl::View& view = impl_->views[c];
    const CoverageEvidence::Raster& raster = evident.rasters[static_cast<size_t>(blur)];
    if (draw(c, raster, pose, s)) {
      const float step = static_cast<float>(raster.cell) / static_cast<float>(impl_->rows_per_cell);
      const float by = step / (static_cast<float>(raster.cell) * static_cast<float>(raster.cell));
      const SpanEnds ends = s.spans[c].ends();
      const auto cell_of_end = s.difference.number_cells();
      s.ends.clear();
      s.points.clear();
      for (size_t i = 0; i < ends.count; ++i) {
        if (cell_of_end[i] < 0) continue;
        const auto cell = static_cast<size_t>(cell_of_end[i]);
        const OutlineSpans::OnEdge at = s.spans[c].edge_of(i);
        const float moves = -ends.side[i] * by * s.difference.confidence(cell);
        const float of_a = moves * (1 - at.t), of_b = moves * at.t;
        const auto vertex_of_slot = view.skin.vertex_of_slot();
        s.ends.push_back({.cell = static_cast<uint32_t>(cell),
                          .points = {s.point_of(vertex_of_slot[at.vertex_a]), s.point_of(vertex_of_slot[at.vertex_b])},
                          .of_x = {of_a, of_b},
                          .of_y = {-at.dx_dy * of_a, -at.dx_dy * of_b}});
      }
      for (const uint32_t vertex : s.points) s.point_of_vertex[vertex] = Scratch::Impl::kNone;
      s.skin_derivative.set_pose(pose, impl_->cameras[c].cam_from_world);
      s.skin_derivative.set_points(s.points);
      s.projections.clear();
      for (const Eigen::Vector3f& x : s.skin_derivative.positions()) s.projections.push_back(view.lens.at(x));
      const size_t stride = s.skin_derivative.row_stride();
      s.point_rows.resize(std::max(s.point_rows.size(), 2 * s.points.size() * stride));
      s.skin_derivative.find_rows(s.projections, s.point_rows.data());
      add_up_ends(s.ends.data(), s.ends.size(), s.point_rows.data(), stride, s.difference.num_end_cells(),
                  s.difference.jacobian(stride));
    }
    const double weight = evident.trust / evidence.noise[c] * outline_scale(raster.cell);
    equations.energy += weight * s.difference.finish();
    s.difference.add_normal_equations(weight, equations.gradient, equations.hessian);
  }
  return equations;
}

}  // namespace silpose
