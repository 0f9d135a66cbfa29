// Replaces how particles move: own_motion BODY.body CALIBRATION.toml VIDEO. They go on at the velocity of the last two
// estimates, with noise. Prints one line per frame.
#include <fmt/format.h>
#include <silpose/silpose.h>

#include <cmath>
#include <exception>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

class Onward final : public silpose::MotionModel {
 public:
  explicit Onward(const silpose::BodyModel& body)
      : noise_(silpose::make_motion_model("diffusion", body.skeleton, body.profile).value()) {}
  int state_size() const override { return noise_->state_size(); }
  silpose::StateBatch states_from_poses(const silpose::StateBatch& poses) const override { return poses; }
  std::vector<int> columns_of(std::span<const int> dofs) const override { return {dofs.begin(), dofs.end()}; }
  std::span<const double> deviation() const override { return noise_->deviation(); }
  int history_length() const override { return 2; }
  void propagate(silpose::StateBatch& states, silpose::HiddenStates*,
                 const silpose::MotionContext& context) const override {
    if (context.history.size() == 2) {
      const auto& before = context.history[0];
      const auto& last = context.history[1];
      const double share = context.dt_s / (before.seconds_ago - last.seconds_ago);
      for (size_t d = 0; d < last.pose.size(); ++d) {
        const double moved = std::remainder(last.pose[d] - before.pose[d], 2 * std::numbers::pi);  // headings wrap
        states.col(static_cast<Eigen::Index>(d)).array() += share * moved;
      }
    }
    noise_->propagate(states, nullptr, context);  // also keeps poses within the limits
  }
  void diffuse(silpose::StateBatch& states, std::span<const double> deviation, uint64_t seed,
               uint64_t stream) const override {
    noise_->diffuse(states, deviation, seed, stream);
  }

 private:
  std::unique_ptr<silpose::MotionModel> noise_;
};

int main(int argc, char** argv) try {
  if (argc != 4) return fmt::print(stderr, "usage: own_motion BODY.body CALIBRATION.toml VIDEO\n"), 2;
  silpose::TrackerOptions tracker;
  tracker.body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
  tracker.cameras = silpose::load_cameras(argv[2]).value();
  tracker.filter = silpose::SamplingOptions{.num_particles = 200, .num_layers = 5};
  tracker.motion_model = std::make_shared<Onward>(*tracker.body);
  auto source = silpose::ObservationSource::open(silpose::open_video(argv[3]).value()).value();
  silpose::Session session(*source, {.tracker = tracker});
  while (const auto report = session.next().value()) {
    fmt::print("{:.3f} s  visual accuracy {:.2f}\n", report->time_s(), report->visual_accuracy);
  }
} catch (const std::exception& failure) {
  fmt::print(stderr, "own_motion: {}\n", failure.what());
  return 1;
}
