#include "silpose/track/make_pose_filter.h"

#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/state_bytes.h"
#include "silpose/filter/estimate.h"
#include "silpose/fit/landmark_proposal.h"
#include "silpose/likelihood/keypoint_likelihood.h"
#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/likelihood/sum_likelihood.h"
#include "silpose/render/render_backend.h"
#include "silpose/track/fitted_filter.h"
#include "silpose/track/pose_estimate.h"
#include "silpose/track/sampling_filter.h"

namespace silpose {
namespace {

using Backends = std::vector<std::shared_ptr<const RenderBackend>>;

// [guess] Of the coarse mesh: how finely fits sample it.
constexpr int kRankingRows = 1;
// [guess] Silhouettes weigh by their sharpness, which is far less than their likelihood; so do keypoints, or few
// particles would be left.
constexpr double kKeypointShare = 0.2;
constexpr int kCroppedSize = 64;  // [guess] raster pixels of the thesis' cropped silhouettes

bool is_root(const Dof& dof) { return dof.joint_idx == 0; }

// Which DOF a filter moves. [D]
template <class Predicate>
std::vector<bool> dofs_where(const Skeleton& skeleton, Predicate predicate) {
  std::vector<bool> free;
  for (const Dof& dof : skeleton.dofs()) free.push_back(predicate(dof));
  return free;
}

// The landmarks [J + E] of each particle. [N]
std::vector<std::vector<Eigen::Vector3d>> landmarks_of(const BodyModel& body, const ParticleSet& particles) {
  const auto num_dofs = static_cast<size_t>(body.skeleton.num_dofs());
  const auto N = static_cast<size_t>(particles.size());
  std::vector<std::vector<Eigen::Vector3d>> positions(N);
  parallel_for(N, 64, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      positions[n] = landmark_positions(body, {particles.states.row(static_cast<Eigen::Index>(n)).data(), num_dofs});
    }
  });
  return positions;
}

// Standard deviation of each coordinate over the particles. Shapes: positions [N][L] -> [L]
std::vector<Eigen::Vector3d> deviations_of(const std::vector<std::vector<Eigen::Vector3d>>& positions,
                                           std::span<const double> weights) {
  std::vector<Eigen::Vector3d> deviations;
  for (size_t l = 0; l < positions.front().size(); ++l) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), variance = Eigen::Vector3d::Zero();
    for (size_t n = 0; n < positions.size(); ++n) mean += weights[n] * positions[n][l];
    for (size_t n = 0; n < positions.size(); ++n) variance += weights[n] * (positions[n][l] - mean).cwiseAbs2();
    deviations.emplace_back(variance.cwiseSqrt());
  }
  return deviations;
}

PoseSpread spread_of(const BodyModel& body, const ParticleSet& particles) {
  const StateBatch poses = particles.states.leftCols(body.skeleton.num_dofs());
  const std::vector<double> weights = particles.weights();
  std::vector<std::vector<Eigen::Vector3d>> positions = landmarks_of(body, particles);
  PoseSpread spread{.dofs = weighted_deviation(poses, weights, periodic_dofs(body.skeleton)),
                    .landmarks = deviations_of(positions, weights),
                    .landmarks_about_root = {}};
  for (std::vector<Eigen::Vector3d>& of_particle : positions) {
    const Eigen::Vector3d root = of_particle.front();
    for (Eigen::Vector3d& position : of_particle) position -= root;
  }
  spread.landmarks_about_root = deviations_of(positions, weights);
  return spread;
}

Backends make_backends(const TrackerOptions& options, const std::shared_ptr<const BodyModel>& body) {
  Backends backends;
  for (const PinholeCamera& camera : options.cameras) {
    backends.push_back(options.make_backend ? options.make_backend(body, camera) : make_cpu_backend(body, camera));
    check(backends.back() != nullptr && &backends.back()->body() == body.get(),
          "make_backend: a backend that is not of the body that was given");
  }
  return backends;
}

std::shared_ptr<const ShapeMetric> metric_of(const TrackerOptions& options) {
  if (options.shape_metric) return options.shape_metric;
  return std::make_shared<const AreaMetric>(
      options.sampling()->metric == Metric::kCoverage ? AreaMetric::Unit::kSamples : AreaMetric::Unit::kPixels);
}

// What particles are weighed by: the kinds of evidence that the options name, and the program's own.
std::shared_ptr<const PoseLikelihood> sampled_likelihood(const TrackerOptions& options, const Backends& backends,
                                                         const std::shared_ptr<const BodyModel>& body,
                                                         Comparison comparison) {
  std::vector<std::shared_ptr<const PoseLikelihood>> parts;
  if (options.evidence != EvidenceKind::kKeypoints) {
    SilhouetteOptions silhouettes{.comparison = comparison, .sharpness = options.sampling()->sharpness};
    if (comparison == Comparison::kCropped) silhouettes.resolution = kCroppedSize;
    parts.push_back(std::make_shared<const SilhouetteLikelihood>(backends, metric_of(options), silhouettes));
  }
  if (options.evidence != EvidenceKind::kSilhouette) {
    // Cropped silhouettes carry no information about the position, nor do image places of a pose that is elsewhere.
    const KeypointOptions keypoints{.alone = options.evidence == EvidenceKind::kKeypoints,
                                    .places = comparison == Comparison::kImage,
                                    .share = kKeypointShare};
    parts.push_back(std::make_shared<const KeypointLikelihood>(body, options.cameras, keypoints));
  }
  if (comparison == Comparison::kImage) {
    parts.insert(parts.end(), options.likelihoods.begin(), options.likelihoods.end());
  }
  if (parts.size() == 1) return parts.front();
  return std::make_shared<const SumLikelihood>(std::move(parts));
}

std::shared_ptr<const MotionModel> motion_of(const TrackerOptions& options) {
  if (options.motion_model) return options.motion_model;
  return make_motion_model(options.sampling()->motion, options.body->skeleton, options.body->profile,
                           {.sigma_deg = options.sampling()->sigma_deg})
      .value();
}

// Poses to regenerate particles from: the program's proposal, or the best few that the network of the first camera with
// keypoints recognises; none where they are not used.
class Recognition {
 public:
  explicit Recognition(const TrackerOptions& options)
      : body_(options.body), cameras_(options.cameras), own_(options.proposal), seed_(options.seed ^ kProposalSeed) {
    is_used_ = options.sampling()->regenerate_from == RegenerateFrom::kNetwork && options.sampling()->regenerate > 0;
    if (is_used_ && !own_) keypoints_ = std::make_shared<const LandmarkProposal>(options.body);
  }
  [[nodiscard]] bool is_used() const { return is_used_; }
  [[nodiscard]] Proposed poses(std::span<const Observation> observations, std::span<const double> last_pose,
                               double dt_s, uint64_t step) const {
    constexpr int kCandidates = 4;  // [guess]
    Rng rng(seed_, step);
    if (own_) return own_->propose({observations, cameras_, last_pose, dt_s}, 0, rng);
    for (size_t c = 0; c < cameras_.size(); ++c) {
      if (observations[c].box().empty() || observations[c].keypoints_3d.empty()) continue;
      if (!make_keypoint_term(*body_, cameras_[c], observations[c], EvidenceKind::kKeypoints)) continue;
      return keypoints_->propose({observations.subspan(c, 1), std::span(cameras_).subspan(c, 1), last_pose, dt_s},
                                 kCandidates, rng);
    }
    return {};
  }

 private:
  static constexpr uint64_t kProposalSeed = 0x7072;
  std::shared_ptr<const BodyModel> body_;
  std::vector<PinholeCamera> cameras_;  // [C]
  std::shared_ptr<const Proposal> own_, keypoints_;
  uint64_t seed_;
  bool is_used_ = false;
};

// Root and pose in one state, compared on the whole image.
class JointFilter final : public PoseFilter {
 public:
  JointFilter(const TrackerOptions& options, const std::shared_ptr<const BodyModel>& body)
      : filter_(*options.sampling(),
                sampled_likelihood(options, make_backends(options, body), body, Comparison::kImage), motion_of(options),
                dofs_where(options.body->skeleton,
                           [&](const Dof& dof) { return !options.sampling()->root_fixed || !is_root(dof); }),
                options.seed),
        recognition_(options) {}

  void start(std::span<const StartingPose> starts) override {
    held_ = starts.front().pose;
    filter_.start(held_);
  }
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override {
    Proposed proposed;
    if (recognition_.is_used()) {
      proposed = recognition_.poses(observations, estimate(), dt_s, filter_.num_steps());
    }
    return filter_.step(observations, proposed, held_, dt_s, seconds);
  }
  FilterReport coast(double dt_s) override { return filter_.coast(dt_s); }
  const ParticleSet& particles() const override { return filter_.particles(); }
  std::vector<double> estimate() const override { return filter_.estimate(); }
  PoseSpread spread() const override { return spread_of(filter_.body(), particles()); }
  std::string state() const override { return to_bytes(held_, filter_.state()); }
  void restore(std::string_view state) override {
    std::optional<SamplingFilter::State> of_filter;
    check(from_bytes(state, held_, of_filter), "JointFilter: not a state of it");
    filter_.restore(std::move(of_filter));
  }

 private:
  SamplingFilter filter_;
  Recognition recognition_;
  std::vector<double> held_;
};

// The thesis' two filters. Pose, with the root's rotation: on cropped silhouettes. Root: on the whole image, with the
// pose just found. In this order the root is fitted to the pose that is drawn, and no offset is left between the two.
class TwoFilters final : public PoseFilter {
 public:
  TwoFilters(const TrackerOptions& options, const std::shared_ptr<const BodyModel>& body)
      : TwoFilters(options, body, make_backends(options, body)) {}

  void start(std::span<const StartingPose> starts) override {
    estimate_ = starts.front().pose;
    pose_filter_.start(estimate_);
    root_filter_.start(estimate_);
    particles_ = pose_filter_.particles();
  }
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override {
    Proposed proposed;
    if (recognition_.is_used()) {
      proposed = recognition_.poses(observations, estimate_, dt_s, pose_filter_.num_steps());
    }
    FilterReport report = pose_filter_.step(observations, proposed, estimate_, dt_s, seconds);
    if (!root_fixed_) root_filter_.step(observations, {}, pose_filter_.estimate(), dt_s, seconds);
    combine();
    return report;
  }
  FilterReport coast(double dt_s) override {
    FilterReport report = pose_filter_.coast(dt_s);
    root_filter_.coast(dt_s);
    combine();
    return report;
  }
  const ParticleSet& particles() const override { return particles_; }
  std::vector<double> estimate() const override { return estimate_; }
  PoseSpread spread() const override { return spread_of(pose_filter_.body(), particles_); }
  std::string state() const override { return to_bytes(estimate_, pose_filter_.state(), root_filter_.state()); }
  void restore(std::string_view state) override {
    std::optional<SamplingFilter::State> of_pose, of_root;
    check(from_bytes(state, estimate_, of_pose, of_root) && of_pose.has_value() == of_root.has_value(),
          "TwoFilters: not a state of it");
    const bool is_started = of_pose.has_value();
    pose_filter_.restore(std::move(of_pose));
    root_filter_.restore(std::move(of_root));
    if (is_started) combine();
  }

 private:
  TwoFilters(const TrackerOptions& options, const std::shared_ptr<const BodyModel>& body, const Backends& backends)
      : body_(options.body),
        root_fixed_(options.sampling()->root_fixed),
        pose_filter_(
            *options.sampling(), sampled_likelihood(options, backends, body, Comparison::kCropped), motion_of(options),
            dofs_where(
                body_->skeleton,
                [&](const Dof& dof) { return root_fixed_ ? !is_root(dof) : !(is_root(dof) && dof.is_translation); }),
            options.seed),
        root_filter_(*options.sampling(), sampled_likelihood(options, backends, body, Comparison::kImage),
                     motion_of(options), dofs_where(body_->skeleton, is_root), options.seed + 1),
        recognition_(options) {}

  // Pose particles, each with a root translation of the root filter's.
  void combine() {
    particles_ = pose_filter_.particles();
    estimate_ = pose_filter_.estimate();
    if (root_fixed_) return;
    const std::vector<double> root = root_filter_.estimate();
    const StateBatch& root_states = root_filter_.particles().states;
    const Skeleton& skeleton = body_->skeleton;
    for (Eigen::Index d = 0; d < skeleton.num_dofs(); ++d) {
      const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
      if (!is_root(dof) || !dof.is_translation) continue;
      estimate_[static_cast<size_t>(d)] = root[static_cast<size_t>(d)];
      particles_.states.col(d) = root_states.col(d);
    }
  }

  std::shared_ptr<const BodyModel> body_;
  bool root_fixed_;
  SamplingFilter pose_filter_, root_filter_;
  Recognition recognition_;
  ParticleSet particles_;
  std::vector<double> estimate_;
};

}  // namespace

std::unique_ptr<PoseFilter> make_pose_filter(const TrackerOptions& options, const TrackedBody& body) {
  options.check();
  if (options.fitted() != nullptr) {
    const auto ranking = std::make_shared<const CoverageLikelihood>(body.coarse, options.cameras, kRankingRows);
    return std::make_unique<FittedFilter>(options, body.likelihood, ranking, body.pose_prior);
  }
  if (options.sampling()->separate_root) return std::make_unique<TwoFilters>(options, body.fine);
  return std::make_unique<JointFilter>(options, body.fine);
}

}  // namespace silpose
