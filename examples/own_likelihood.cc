// Adds evidence of one's own to a track: own_likelihood BODY.body CALIBRATION.toml VIDEO X Y Z. The right hand holds a
// rail at X Y Z (metres, world), to about 2 cm. Prints, line by line, the time and how far the hand is from there.
#include <fmt/format.h>
#include <silpose/body/point_motion.h>
#include <silpose/silpose.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <utility>

class HandOnRail final : public silpose::PoseLikelihood {
 public:
  HandOnRail(std::shared_ptr<const silpose::BodyModel> body, Eigen::Vector3d rail)
      : body_(std::move(body)), rail_(std::move(rail)), hand_(body_->skeleton.find_joint("right_hand").value()) {}
  const silpose::BodyModel& body() const override { return *body_; }
  std::unique_ptr<const Evidence> prepare(std::span<const silpose::Observation>) const override {
    return std::make_unique<Evidence>();
  }
  void add_log_likelihood(const Evidence& evidence, const silpose::StateBatch& states,
                          std::span<double> out) const override {
    const auto D = static_cast<size_t>(body_->skeleton.num_dofs());
    for (size_t n = 0; n < out.size(); ++n) out[n] -= 0.5 * linearise(evidence, {states.row(n).data(), D}).energy;
  }
  bool can_linearise() const override { return true; }
  silpose::NormalEquations linearise(const Evidence&, std::span<const double> pose) const override {
    const silpose::PointMotion motion(body_->skeleton, pose);
    const Eigen::Vector3d hand = motion.position(hand_, Eigen::Vector3d::Zero());
    const Eigen::MatrixXd jacobian = motion.jacobian(hand_, hand) / kDeviation_m;
    const Eigen::Vector3d off = (hand - rail_) / kDeviation_m;
    return {off.squaredNorm(), jacobian.transpose() * off, jacobian.transpose() * jacobian};
  }

 private:
  static constexpr double kDeviation_m = 0.02;
  std::shared_ptr<const silpose::BodyModel> body_;
  Eigen::Vector3d rail_;
  int hand_;
};

int main(int argc, char** argv) try {
  if (argc != 7) return fmt::print(stderr, "usage: own_likelihood BODY.body CALIBRATION.toml VIDEO X Y Z\n"), 2;
  const Eigen::Vector3d rail(std::atof(argv[4]), std::atof(argv[5]), std::atof(argv[6]));
  silpose::TrackerOptions tracker;
  tracker.body = std::make_shared<silpose::BodyModel>(silpose::load_body(argv[1]).value());
  tracker.cameras = silpose::load_cameras(argv[2]).value();
  tracker.likelihoods = {std::make_shared<HandOnRail>(tracker.body, rail)};
  const silpose::Skeleton& skeleton = tracker.body->skeleton;
  auto source = silpose::ObservationSource::open(silpose::open_video(argv[3]).value()).value();
  silpose::Session session(*source, {.tracker = tracker});
  while (const auto report = session.next().value()) {
    if (report->pose.empty()) continue;
    const auto joints = skeleton.forward_kinematics(report->pose);
    const auto hand = static_cast<size_t>(skeleton.find_joint("right_hand").value());
    fmt::print("{:.3f} s  hand {:.3f} m from the rail\n", report->time_s(), (joints[hand].translation - rail).norm());
  }
} catch (const std::exception& failure) {
  fmt::print(stderr, "own_likelihood: {}\n", failure.what());
  return 1;
}
