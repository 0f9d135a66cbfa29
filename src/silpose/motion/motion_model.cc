#include "silpose/motion/motion_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"

namespace silpose {
namespace {

constexpr size_t kGrain = 64;  // [guess] particles per task

// [guess] What a frame's acceleration noise changes a velocity by, against the frame's noise of plain diffusion: a hip
// swings through 25 degrees once a second, so its velocity changes by about a degree per frame in every frame.
constexpr double kVelocityShare = 0.5;

class Diffusion final : public MotionModel {
 public:
  Diffusion(Skeleton skeleton, const RigProfile& profile, const MotionOptions& options)
      : skeleton_(std::move(skeleton)), deviation_(noise_deviation(profile, options.sigma_deg)) {}

  int state_size() const override { return skeleton_.num_dofs(); }
  StateBatch states_from_poses(const StateBatch& poses) const override {
    check(poses.cols() == skeleton_.num_dofs(), "diffusion: poses of {} columns", poses.cols());
    return poses;
  }
  std::vector<int> columns_of(std::span<const int> dofs) const override { return {dofs.begin(), dofs.end()}; }
  std::span<const double> deviation() const override { return deviation_; }

  void propagate(StateBatch& states, HiddenStates*, const MotionContext& context) const override {
    check(context.dt_s >= 0, "diffusion: {} s", context.dt_s);
    const double growth = std::sqrt(context.dt_s / kNoiseInterval_s);
    std::vector<double> grown = deviation_;
    for (double& value : grown) value *= growth;
    diffuse(states, grown, context.seed, context.stream);
  }

  void diffuse(StateBatch& states, std::span<const double> deviation, uint64_t seed, uint64_t stream) const override {
    check(states.cols() == state_size() && deviation.size() == static_cast<size_t>(state_size()),
          "diffusion: states of {} columns, {} deviations for {} DOF", states.cols(), deviation.size(), state_size());
    parallel_for(static_cast<size_t>(states.rows()), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        Rng rng(seed, stream, i);
        double* const x = states.row(static_cast<Eigen::Index>(i)).data();
        for (size_t d = 0; d < deviation.size(); ++d) x[d] += deviation[d] * rng.normal();
        skeleton_.clamp({x, deviation.size()});
      }
    });
  }

 private:
  Skeleton skeleton_;
  std::vector<double> deviation_;  // [D]
};

class FirstOrderAugmented final : public MotionModel {
 public:
  FirstOrderAugmented(Skeleton skeleton, const RigProfile& profile, const MotionOptions& options)
      : skeleton_(std::move(skeleton)),
        num_dofs_(static_cast<size_t>(skeleton_.num_dofs())),
        velocity_decay_per_s_(options.velocity_decay_per_s),
        deviation_(noise_deviation(profile, options.sigma_deg)) {
    check(std::isfinite(velocity_decay_per_s_) && velocity_decay_per_s_ >= 0, "first order: velocity decay of {} 1/s",
          velocity_decay_per_s_);
    for (size_t d = 0; d < num_dofs_; ++d) deviation_.push_back(kVelocityShare * deviation_[d] / kNoiseInterval_s);
  }

  int state_size() const override { return static_cast<int>(2 * num_dofs_); }

  StateBatch states_from_poses(const StateBatch& poses) const override {
    check(static_cast<size_t>(poses.cols()) == num_dofs_, "first order: poses of {} columns", poses.cols());
    StateBatch states = StateBatch::Zero(poses.rows(), state_size());
    states.leftCols(poses.cols()) = poses;
    return states;
  }

  std::vector<int> columns_of(std::span<const int> dofs) const override {
    std::vector<int> columns(dofs.begin(), dofs.end());
    for (const int d : dofs) columns.push_back(d + static_cast<int>(num_dofs_));
    return columns;
  }

  std::span<const double> deviation() const override { return deviation_; }

  void propagate(StateBatch& states, HiddenStates*, const MotionContext& context) const override {
    const double dt_s = context.dt_s;
    check(states.cols() == state_size(), "first order: states of {} columns", states.cols());
    check(dt_s >= 0, "first order: {} s", dt_s);
    const double kept = std::exp(-velocity_decay_per_s_ * dt_s);
    // dt * n of eq. 2.18, with the n of a white acceleration: its variance is as 1 / dt, so that the spread after a
    // second is the same at any frame rate.
    const double growth = std::sqrt(dt_s / kNoiseInterval_s);
    for_each_state(states, context.seed, context.stream, [&](double* x, double* v, Rng& rng) {
      for (size_t d = 0; d < num_dofs_; ++d) {
        const double velocity_change = growth * deviation_[num_dofs_ + d] * rng.normal();
        x[d] += dt_s * v[d] + 0.5 * dt_s * velocity_change;
        v[d] = kept * v[d] + velocity_change;
      }
    });
  }

  void diffuse(StateBatch& states, std::span<const double> deviation, uint64_t seed, uint64_t stream) const override {
    check(states.cols() == state_size() && deviation.size() == 2 * num_dofs_,
          "first order: states of {} columns, {} deviations for {} DOF", states.cols(), deviation.size(), num_dofs_);
    for_each_state(states, seed, stream, [&](double* x, double* v, Rng& rng) {
      for (size_t d = 0; d < num_dofs_; ++d) x[d] += deviation[d] * rng.normal();
      for (size_t d = 0; d < num_dofs_; ++d) v[d] += deviation[num_dofs_ + d] * rng.normal();
    });
  }

 private:
  template <class Move>
  void for_each_state(StateBatch& states, uint64_t seed, uint64_t stream, const Move& move) const {
    parallel_for(static_cast<size_t>(states.rows()), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        Rng rng(seed, stream, i);
        double* const x = states.row(static_cast<Eigen::Index>(i)).data();
        double* const v = x + num_dofs_;
        move(x, v, rng);
        stop_at_limits({x, num_dofs_}, {v, num_dofs_});
        skeleton_.clamp({x, num_dofs_});
      }
    });
  }

  // A joint that runs into its limit stops there.
  void stop_at_limits(std::span<const double> x, std::span<double> v) const {
    const std::span<const Dof> dofs = skeleton_.dofs();
    for (size_t d = 0; d < num_dofs_; ++d) {
      if (!dofs[d].has_limits()) continue;
      if (x[d] <= dofs[d].lower) v[d] = std::max(v[d], 0.0);
      if (x[d] >= dofs[d].upper) v[d] = std::min(v[d], 0.0);
    }
  }

  Skeleton skeleton_;
  size_t num_dofs_;
  double velocity_decay_per_s_;
  std::vector<double> deviation_;  // [2 D]
};

struct NamedModel {
  std::string_view name;
  std::unique_ptr<MotionModel> (*make)(const Skeleton& skeleton, const RigProfile& profile,
                                       const MotionOptions& options);
};

template <class Model>
std::unique_ptr<MotionModel> make(const Skeleton& skeleton, const RigProfile& profile, const MotionOptions& options) {
  return std::make_unique<Model>(skeleton, profile, options);
}

constexpr std::array kModels = {NamedModel{"diffusion", make<Diffusion>},
                                NamedModel{"first-order-augmented", make<FirstOrderAugmented>}};
constexpr auto kNames = [] {
  std::array<std::string_view, kModels.size()> names;
  for (size_t i = 0; i < names.size(); ++i) names[i] = kModels[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> motion_model_names() { return kNames; }

Result<std::unique_ptr<MotionModel>> make_motion_model(const std::string& name, const Skeleton& skeleton,
                                                       const RigProfile& profile, const MotionOptions& options) {
  check_profile(profile, skeleton);
  const auto model = std::ranges::find(kModels, name, &NamedModel::name);
  if (model == kModels.end()) return error("motion '{}': not one of {}", name, fmt::join(kNames, ", "));
  return model->make(skeleton, profile, options);
}

}  // namespace silpose
