#include "silpose/offline/smoother.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/levenberg_marquardt.h"
#include "silpose/base/parallel.h"
#include "silpose/offline/footing.h"

namespace silpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// [guess] Largest rotation (radians) and translation (metres) of one step.
constexpr SmallestGain kSmallestGain{.relative = 1e-4};
constexpr double kMaxRotation = 0.35, kMaxTranslation = 0.3;

// A symmetric block tridiagonal matrix: blocks of two frames each, so that accelerations, which tie three frames, reach
// no further than the next block.
class BlockTridiagonal {
 public:
  BlockTridiagonal(size_t num_frames, Eigen::Index D)
      : D_(D),
        diagonal_((num_frames + 1) / 2, MatrixXd::Zero(2 * D, 2 * D)),
        below_(diagonal_.size(), MatrixXd::Zero(2 * D, 2 * D)) {
    // An odd last block has a second half of its own that ties to nothing.
    if (num_frames % 2 == 1) diagonal_.back().bottomRightCorner(D, D).setIdentity();
  }

  // The block of frames (s, t), s - t at most two frames apart. REQUIRES: s >= t.
  Eigen::Block<MatrixXd> at(size_t s, size_t t) {
    MatrixXd& block = s / 2 == t / 2 ? diagonal_[t / 2] : below_[s / 2];
    return block.block(static_cast<Eigen::Index>(s % 2) * D_, static_cast<Eigen::Index>(t % 2) * D_, D_, D_);
  }

  void damp(double damping) {
    for (MatrixXd& block : diagonal_) block.diagonal() *= 1 + damping;
  }

  // Factorises in place. Frames (s, t) with s > t in one block were written below the diagonal only.
  void factorise() {
    factors_.resize(diagonal_.size());
    for (size_t k = 0; k < diagonal_.size(); ++k) {
      MatrixXd full = diagonal_[k].selfadjointView<Eigen::Lower>();
      if (k > 0) full -= below_[k] * factors_[k - 1].solve(below_[k].transpose());
      factors_[k].compute(full);
    }
  }

  // Solves for a right-hand side [T] of [D].
  [[nodiscard]] std::vector<VectorXd> solve(const std::vector<VectorXd>& right) const {
    std::vector<VectorXd> x(diagonal_.size());
    for (size_t k = 0; k < x.size(); ++k) {
      x[k] = VectorXd::Zero(2 * D_);
      x[k].head(D_) = right[2 * k];
      if (2 * k + 1 < right.size()) x[k].tail(D_) = right[2 * k + 1];
      if (k > 0) x[k] -= below_[k] * factors_[k - 1].solve(x[k - 1]);
    }
    for (size_t k = x.size(); k-- > 0;) {
      if (k + 1 < x.size()) x[k] -= below_[k + 1].transpose() * x[k + 1];
      x[k] = factors_[k].solve(x[k]);
    }
    std::vector<VectorXd> result;
    for (size_t t = 0; t < right.size(); ++t)
      result.emplace_back(x[t / 2].segment(static_cast<Eigen::Index>(t % 2) * D_, D_));
    return result;
  }

  // Diagonal blocks [T] of the inverse.
  [[nodiscard]] std::vector<MatrixXd> marginals(size_t num_frames) const {
    std::vector<MatrixXd> result(num_frames);
    MatrixXd next;
    for (size_t k = diagonal_.size(); k-- > 0;) {
      MatrixXd inverse = factors_[k].solve(MatrixXd::Identity(2 * D_, 2 * D_));
      if (k + 1 < diagonal_.size()) {
        const MatrixXd gain = below_[k + 1] * inverse;
        inverse += gain.transpose() * next * gain;
      }
      next = inverse;
      for (size_t half = 0; half < 2 && 2 * k + half < num_frames; ++half) {
        const auto at = static_cast<Eigen::Index>(half) * D_;
        result[2 * k + half] = inverse.block(at, at, D_, D_);
      }
    }
    return result;
  }

 private:
  Eigen::Index D_;
  std::vector<MatrixXd> diagonal_, below_;  // below_[k] ties block k to block k - 1
  std::vector<Eigen::LDLT<MatrixXd>> factors_;
};

// What frames and motion say at some poses.
struct Linearised {
  double cost = 0;
  std::vector<VectorXd> gradient;  // [T] of half the cost
  std::vector<MatrixXd> hessian;   // [T] of the frames alone, and what rests on the floor in them
  std::vector<MatrixXd> across;    // [T] of what rests on the floor: from a frame (rows) to the one before
};

struct Point {
  std::vector<VectorXd> poses;
  Linearised equations;
  [[nodiscard]] double cost() const { return equations.cost; }
};

class Problem {
 public:
  Problem(const CoverageLikelihood& likelihood, const PosePrior& pose_prior, std::span<const ClipInstant* const> clip,
          const std::vector<bool>& seen, const SmootherOptions& options)
      : likelihood_(likelihood),
        pose_prior_(pose_prior),
        clip_(clip),
        seen_(seen),
        options_(options),
        noise_(options.noise),
        acceleration_(likelihood.body().profile.acceleration) {
    for (double& deviation : acceleration_) deviation *= options.acceleration;
  }

  // Decides what rests on the floor, until it is called again.
  void find_footholds(const std::vector<VectorXd>& poses) {
    footholds_.assign(poses.size(), {});
    if (pose_prior_.floor_points().empty()) return;
    const Skeleton& skeleton = likelihood_.body().skeleton;
    for (size_t t = 1; t < poses.size(); ++t) {
      footholds_[t] = foot_contacts(pose_prior_.floor_points(), {skeleton, view(poses[t - 1])},
                                    {skeleton, view(poses[t])}, seconds_before(t));
    }
  }

  // From here on outlines are as noisy as they prove to be, seen from these poses.
  void estimate_noise(const std::vector<VectorXd>& poses) {
    std::vector<std::vector<double>> found(poses.size());
    parallel_for(poses.size(), 4, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(likelihood_);
      for (size_t t = begin; t < end; ++t) {
        if (!seen_[t]) continue;
        const CoverageEvidence evidence = likelihood_.evidence_of(clip_[t]->observations, Blur::k8, Blur::k8);
        found[t] = likelihood_.estimate_noise(evidence, view(poses[t]), scratch);
      }
    });
    noise_.assign(likelihood_.cameras().size(), 0);
    for (size_t c = 0; c < noise_.size(); ++c) {
      double sum = 0, count = 0;
      for (const auto& noise : found) {
        if (!noise.empty() && noise[c] > 0) sum += noise[c], ++count;
      }
      if (count > 0) noise_[c] = sum / count;
    }
  }
  [[nodiscard]] const std::vector<double>& noise() const { return noise_; }

  [[nodiscard]] Linearised linearise(const std::vector<VectorXd>& poses, Blur blur) const {
    const size_t T = poses.size();
    const Eigen::Index D = poses.front().size();
    Linearised at{0, std::vector<VectorXd>(T), std::vector<MatrixXd>(T), std::vector<MatrixXd>(T)};
    std::vector<double> costs(T, 0.0);
    parallel_for(T, 4, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(likelihood_);
      for (size_t t = begin; t < end; ++t) {
        at.gradient[t] = VectorXd::Zero(D);
        at.hessian[t] = MatrixXd::Zero(D, D);
        bool directions_seen = false;
        if (seen_[t]) {
          CoverageEvidence evidence = likelihood_.evidence_of(clip_[t]->observations, blur, blur, options_.evidence);
          directions_seen = evidence.has_directions();
          evidence.set_noise(noise_);
          NormalEquations equations = likelihood_.linearise(evidence, blur, view(poses[t]), scratch);
          costs[t] = equations.energy;
          at.gradient[t] = std::move(equations.gradient);
          at.hessian[t] = std::move(equations.hessian);
        }
        costs[t] += pose_prior_.add(poses[t], {options_.rest_weight, directions_seen}, at.gradient[t], at.hessian[t]);
      }
    });
    for (const double cost : costs) at.cost += cost;
    for (size_t t = 1; t < T; ++t) {
      if (footholds_[t].empty()) continue;
      const Skeleton& skeleton = likelihood_.body().skeleton;
      FootholdEquations held = hold(footholds_[t], {skeleton, view(poses[t - 1])}, {skeleton, view(poses[t])}, D);
      at.cost += held.cost;
      at.gradient[t - 1] += held.gradient;
      at.gradient[t] += held.gradient_next;
      at.hessian[t - 1] += held.hessian;
      at.hessian[t] += held.hessian_next;
      at.across[t] = std::move(held.across);
    }
    for (size_t t = 1; t + 1 < T; ++t) {
      const auto [before, after, weight] = acceleration_terms(t);
      const VectorXd change = after * poses[t + 1] - (after + before) * poses[t] + before * poses[t - 1];
      const VectorXd pull = weight.cwiseProduct(change);
      at.cost += change.dot(pull);
      at.gradient[t - 1] += before * pull;
      at.gradient[t] -= (after + before) * pull;
      at.gradient[t + 1] += after * pull;
    }
    return at;
  }

  [[nodiscard]] BlockTridiagonal normal_matrix(const Linearised& at) const {
    const size_t T = at.hessian.size();
    const Eigen::Index D = at.gradient.front().size();
    BlockTridiagonal matrix(T, D);
    for (size_t t = 0; t < T; ++t) {
      matrix.at(t, t) += at.hessian[t];
      if (at.across[t].size() > 0) matrix.at(t, t - 1) += at.across[t];
      matrix.at(t, t).diagonal().array() += 1e-6;
    }
    for (size_t t = 1; t + 1 < T; ++t) {
      const auto [before, after, weight] = acceleration_terms(t);
      const double middle = -(after + before);
      const double factor[3] = {before, middle, after};
      for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j <= i; ++j) {
          matrix.at(t - 1 + i, t - 1 + j).diagonal() += factor[i] * factor[j] * weight;
        }
      }
    }
    return matrix;
  }

 private:
  [[nodiscard]] double seconds_before(size_t t) const {
    return static_cast<double>(clip_[t]->time_ns - clip_[t - 1]->time_ns) * 1e-9;
  }

  struct AccelerationTerms {
    double before, after;  // 1 / dt to the frame before and after, in noise intervals
    VectorXd weight;       // [D] 1 / variance of the change of velocity
  };
  [[nodiscard]] AccelerationTerms acceleration_terms(size_t t) const {
    const double before = seconds_before(t) / kNoiseInterval_s, after = seconds_before(t + 1) / kNoiseInterval_s;
    VectorXd weight(std::ssize(acceleration_));
    for (Eigen::Index d = 0; d < weight.size(); ++d) {
      const double deviation = acceleration_[static_cast<size_t>(d)];
      weight[d] = 1 / (deviation * deviation * 0.5 * (before + after));
    }
    return {1 / before, 1 / after, weight};
  }

  const CoverageLikelihood& likelihood_;
  const PosePrior& pose_prior_;
  std::span<const ClipInstant* const> clip_;
  const std::vector<bool>& seen_;
  const SmootherOptions& options_;
  std::vector<double> noise_;  // [C]
  std::vector<double> acceleration_;
  std::vector<std::vector<FootContact>> footholds_;  // [T] from the frame before
};

void keep_whole_turns(const Skeleton& skeleton, std::vector<VectorXd>& poses) {
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    if (!skeleton.dofs()[static_cast<size_t>(d)].is_periodic) continue;
    for (size_t t = 1; t < poses.size(); ++t) poses[t][d] = poses[t - 1][d] + wrap_angle(poses[t][d] - poses[t - 1][d]);
  }
}

}  // namespace

SmoothedPoses smooth_poses(const CoverageLikelihood& likelihood, const PosePrior& pose_prior,
                           std::span<const ClipInstant* const> clip, const std::vector<bool>& seen,
                           std::vector<Eigen::VectorXd> poses, const SmootherOptions& options,
                           const std::function<bool()>& proceed) {
  check(!poses.empty() && poses.size() == clip.size() && seen.size() == clip.size(),
        "smooth_poses: {} poses of {} instants, {} of them marked", poses.size(), clip.size(), seen.size());
  check(!options.stages.empty(), "smooth_poses: no stage");
  const Skeleton& skeleton = likelihood.body().skeleton;
  keep_whole_turns(skeleton, poses);
  Problem problem(likelihood, pose_prior, clip, seen, options);
  Point at{std::move(poses), {}};
  for (const FitStage& stage : options.stages) {
    if (&stage != &options.stages.front() && &stage == &options.stages.back()) problem.estimate_noise(at.poses);
    problem.find_footholds(at.poses);
    at.equations = problem.linearise(at.poses, stage.blur);
    levenberg_marquardt(
        at, stage.max_iterations, kSmallestGain, [&](const Point& from, double damping) -> std::optional<Point> {
          if (proceed && !proceed()) return std::nullopt;
          BlockTridiagonal matrix = problem.normal_matrix(from.equations);
          matrix.damp(damping);
          matrix.factorise();
          const std::vector<VectorXd> step = matrix.solve(from.equations.gradient);
          Point next{from.poses, {}};
          for (size_t t = 0; t < step.size(); ++t) {
            for (Eigen::Index d = 0; d < step[t].size(); ++d) {
              const double most =
                  skeleton.dofs()[static_cast<size_t>(d)].is_translation ? kMaxTranslation : kMaxRotation;
              next.poses[t][d] -= std::clamp(step[t][d], -most, most);
            }
          }
          next.equations = problem.linearise(next.poses, stage.blur);
          return next;
        });
  }
  BlockTridiagonal matrix = problem.normal_matrix(at.equations);
  matrix.factorise();
  SmoothedPoses result{.poses = std::move(at.poses), .covariances = {}, .noise = problem.noise(), .cost = at.cost()};
  result.covariances = matrix.marginals(result.poses.size());
  for (VectorXd& pose : result.poses) clamp_to_limits(skeleton, pose);
  return result;
}

}  // namespace silpose
