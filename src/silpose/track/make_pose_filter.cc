#include "silpose/track/make_pose_filter.h"

#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/state_bytes.h"
#include "silpose/filter/estimate.h"
#include "silpose/fit/landmark_proposal.h"
#include "silpose/track/fitted_filter.h"
#include "silpose/track/pose_estimate.h"
#include "silpose/track/sampling_filter.h"

namespace silpose {
namespace {

using Renderers = std::vector<std::shared_ptr<const BatchRenderer>>;

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

LikelihoodOptions likelihood_options(const TrackerOptions& options) {
  return {
      .metric = options.sampling()->metric, .sharpness = options.sampling()->sharpness, .evidence = options.evidence};
}

LikelihoodOptions cropped_options(const TrackerOptions& options) {
  LikelihoodOptions cropped = likelihood_options(options);
  cropped.comparison = Comparison::kCropped;
  cropped.resolution = kCroppedSize;
  return cropped;
}

// Poses that the network of the first camera with keypoints recognises, the best few; none where it is not used.
class Recognition {
 public:
  explicit Recognition(const TrackerOptions& options) : body_(options.body), cameras_(options.cameras) {
    if (options.sampling()->regenerate_from != RegenerateFrom::kNetwork || options.sampling()->regenerate == 0) return;
    for (const PinholeCamera& camera : options.cameras) proposals_.emplace_back(options.body, camera);
  }
  [[nodiscard]] StateBatch poses(std::span<const Observation> observations) const {
    constexpr int kCandidates = 4;  // [guess]
    for (size_t c = 0; c < proposals_.size(); ++c) {
      if (observations[c].box().empty() || observations[c].keypoints_3d.empty()) continue;
      if (!make_keypoint_term(*body_, cameras_[c], observations[c], EvidenceKind::kKeypoints)) continue;
      Rng unused(0, 0);
      return proposals_[c].propose(observations[c], kCandidates, unused);
    }
    return StateBatch(0, body_->skeleton.num_dofs());
  }

 private:
  std::shared_ptr<const BodyModel> body_;
  std::vector<PinholeCamera> cameras_;       // [C]
  std::vector<LandmarkProposal> proposals_;  // [C], or none
};

// Root and pose in one state, compared on the whole image.
class JointFilter final : public PoseFilter {
 public:
  JointFilter(const TrackerOptions& options, Renderers renderers)
      : likelihood_(std::move(renderers), likelihood_options(options)),
        filter_(*options.sampling(), likelihood_,
                dofs_where(options.body->skeleton,
                           [&](const Dof& dof) { return !options.sampling()->root_fixed || !is_root(dof); }),
                options.seed),
        recognition_(options) {}

  void start(std::span<const StartingPose> starts) override {
    held_ = starts.front().pose;
    filter_.start(held_);
  }
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override {
    return filter_.step(likelihood_.prepare(observations), recognition_.poses(observations), held_, dt_s, seconds);
  }
  FilterReport coast(double dt_s) override { return filter_.coast(dt_s); }
  const ParticleSet& particles() const override { return filter_.particles(); }
  std::vector<double> estimate() const override { return filter_.estimate(); }
  PoseSpread spread() const override { return spread_of(likelihood_.body(), particles()); }
  std::string state() const override { return to_bytes(held_, filter_.state()); }
  void restore(std::string_view state) override {
    std::optional<FilterState> of_filter;
    check(from_bytes(state, held_, of_filter), "JointFilter: not a state of it");
    filter_.restore(std::move(of_filter));
  }

 private:
  SilhouetteLikelihood likelihood_;
  SamplingFilter filter_;
  Recognition recognition_;
  std::vector<double> held_;
};

// The thesis' two filters. Pose, with the root's rotation: on cropped silhouettes. Root: on the whole image, with the
// pose just found. In this order the root is fitted to the pose that is drawn, and no offset is left between the two.
class TwoFilters final : public PoseFilter {
 public:
  TwoFilters(const TrackerOptions& options, const Renderers& renderers)
      : body_(options.body),
        root_fixed_(options.sampling()->root_fixed),
        cropped_(renderers, cropped_options(options)),
        whole_(renderers, likelihood_options(options)),
        pose_filter_(*options.sampling(), cropped_,
                     dofs_where(body_->skeleton,
                                [&](const Dof& dof) {
                                  return root_fixed_ ? !is_root(dof) : !(is_root(dof) && dof.is_translation);
                                }),
                     options.seed),
        root_filter_(*options.sampling(), whole_, dofs_where(body_->skeleton, is_root), options.seed + 1),
        recognition_(options) {}

  void start(std::span<const StartingPose> starts) override {
    estimate_ = starts.front().pose;
    pose_filter_.start(estimate_);
    root_filter_.start(estimate_);
    particles_ = pose_filter_.particles();
  }
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override {
    FilterReport report =
        pose_filter_.step(cropped_.prepare(observations), recognition_.poses(observations), estimate_, dt_s, seconds);
    if (!root_fixed_) root_filter_.step(whole_.prepare(observations), {}, pose_filter_.estimate(), dt_s, seconds);
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
  PoseSpread spread() const override { return spread_of(whole_.body(), particles_); }
  std::string state() const override { return to_bytes(estimate_, pose_filter_.state(), root_filter_.state()); }
  void restore(std::string_view state) override {
    std::optional<FilterState> of_pose, of_root;
    check(from_bytes(state, estimate_, of_pose, of_root) && of_pose.has_value() == of_root.has_value(),
          "TwoFilters: not a state of it");
    const bool is_started = of_pose.has_value();
    pose_filter_.restore(std::move(of_pose));
    root_filter_.restore(std::move(of_root));
    if (is_started) combine();
  }

 private:
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
  SilhouetteLikelihood cropped_, whole_;
  SamplingFilter pose_filter_, root_filter_;
  Recognition recognition_;
  ParticleSet particles_;
  std::vector<double> estimate_;
};

}  // namespace

std::unique_ptr<PoseFilter> make_pose_filter(const TrackerOptions& options, const Likelihoods& likelihoods) {
  options.check();
  if (options.fitted() != nullptr) {
    return std::make_unique<FittedFilter>(options, likelihoods.fine, likelihoods.coarse, likelihoods.pose_prior);
  }
  if (options.sampling()->separate_root) return std::make_unique<TwoFilters>(options, likelihoods.renderers);
  return std::make_unique<JointFilter>(options, likelihoods.renderers);
}

}  // namespace silpose
