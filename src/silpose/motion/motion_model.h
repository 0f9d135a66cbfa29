// MotionModel: how particles move between frames.
//
// Contract: a state has D' >= D columns, of which the first D are a pose. propagate() moves every state forward by dt_s
// with noise; diffuse() adds noise of given deviations and moves nothing forward, as annealing needs between layers.
// After either, poses are within the skeleton's limits and periodic DOF are wrapped. Particle i of a call draws from
// the stream (seed, stream, i) alone, so results do not depend on threads. What a particle carries besides numbers, a
// model keeps in hidden states, which follow the particles through resampling.
//
//   diffusion               x + N(0, S dt)                                                   D' = D
//   first-order-augmented   [x, v]: x moves by v; an acceleration that is white noise changes both   D' = 2 D
//
// Source: cormier2019 eq. 2.15 and 2.18 (references.bib); augmented state: hue2002.
// Threads: models are constant; any thread may call.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/skeleton.h"
#include "silpose/filter/state_batch.h"
#include "silpose/motion/noise.h"

namespace silpose {

struct MotionOptions {
  double sigma_deg = kTypicalSigmaDeg;  // deviation of a typical rotation in 1/30 s; every other scales with it
  double velocity_decay_per_s = 0;      // velocities fall by exp(-decay * dt): 0 is the thesis' equation
};

// What a model may know when it moves particles. New members have defaults, so that models need not change.
struct MotionContext {
  double dt_s = 0;  // >= 0
  // The filter's estimates until now, oldest first: at most the model's history_length().
  struct Past {
    double seconds_ago = 0;    // before the time from which particles move
    std::vector<double> pose;  // [D]
    static auto members(auto& p) { return std::tie(p.seconds_ago, p.pose); }
  };
  std::span<const Past> history;
  uint64_t seed = 0, stream = 0;  // of the random numbers, base/rng.h
};

// What particles carry besides their rows of numbers, such as the contacts of a simulated body. Entry n is particle
// n's.
class HiddenStates {
 public:
  virtual ~HiddenStates() = default;
  // After resampling: particle n continues particle ancestors[n], or is a new one (kRegenerate). Shapes: [N].
  virtual void select(std::span<const int> ancestors) = 0;
  // State from which another one of the same model continues exactly as this one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] virtual std::string state() const = 0;
  virtual void restore(std::string_view state) = 0;
};

class MotionModel {
 public:
  virtual ~MotionModel() = default;

  // D': columns of a state.
  [[nodiscard]] virtual int state_size() const = 0;

  // States [N, D'] of poses [N, D], at rest.
  [[nodiscard]] virtual StateBatch states_from_poses(const StateBatch& poses) const = 0;

  // The state columns that belong to DOF [..] of a pose: for holding, or recombining, a limb with its velocities.
  [[nodiscard]] virtual std::vector<int> columns_of(std::span<const int> dofs) const = 0;

  // [D'] noise of 1/30 s on each column, radians, metres, and those per second.
  [[nodiscard]] virtual std::span<const double> deviation() const = 0;

  // How many past estimates propagate() uses.
  [[nodiscard]] virtual int history_length() const { return 0; }
  // Hidden states of N particles at rest; null: there are none.
  [[nodiscard]] virtual std::unique_ptr<HiddenStates> make_hidden(int num_particles) const {
    (void)num_particles;
    return nullptr;
  }

  // Shapes: states [N, D'] with poses within the limits. `hidden`: those of the same N particles, from make_hidden().
  virtual void propagate(StateBatch& states, HiddenStates* hidden, const MotionContext& context) const = 0;

  // Shapes: states [N, D'], deviation [D'].
  virtual void diffuse(StateBatch& states, std::span<const double> deviation, uint64_t seed, uint64_t stream) const = 0;
};

// The names that make_motion_model() knows.
std::span<const std::string_view> motion_model_names();

// A model of a rig by its name on the command line; it keeps a copy of the skeleton.
// Errors: an unknown name. Throws std::invalid_argument for options out of range, and for a profile of another
// skeleton.
Result<std::unique_ptr<MotionModel>> make_motion_model(const std::string& name, const Skeleton& skeleton,
                                                       const RigProfile& profile, const MotionOptions& options = {});

}  // namespace silpose
