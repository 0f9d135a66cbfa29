#include "silpose/likelihood/keypoint_likelihood.h"

#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"

namespace silpose {

struct KeypointLikelihood::Prepared final : Evidence {
  struct View {
    double trust = 0;
    std::shared_ptr<const KeypointTerm> term;
  };
  std::vector<View> views;  // of the cameras that add something
};

KeypointLikelihood::KeypointLikelihood(std::shared_ptr<const BodyModel> body, std::vector<PinholeCamera> cameras,
                                       KeypointOptions options)
    : body_(std::move(body)), cameras_(std::move(cameras)), options_(options) {
  check(body_ != nullptr, "KeypointLikelihood: no body");
  check(!cameras_.empty(), "KeypointLikelihood: no camera");
  check(options_.share > 0, "KeypointLikelihood: a share of {}", options_.share);
}

std::unique_ptr<const PoseLikelihood::Evidence> KeypointLikelihood::prepare(
    std::span<const Observation> observations) const {
  check_number(observations, cameras_.size());
  const EvidenceKind kind = options_.alone ? EvidenceKind::kKeypoints : EvidenceKind::kBoth;
  auto prepared = std::make_unique<Prepared>();
  for (size_t c = 0; c < cameras_.size(); ++c) {
    const Observation& observation = observations[c];
    check_fits(observation, cameras_[c]);
    if (observation.ignored && observation.known(observation.mask).count() == 0) continue;
    if (observation.trust.nothing_found || observation.box().empty() || observation.trust.overall <= 0) continue;
    if (auto term = make_keypoint_term(*body_, cameras_[c], observation, kind, options_.places)) {
      prepared->views.push_back({observation.trust.overall, std::move(term)});
    }
  }
  return prepared;
}

void KeypointLikelihood::add_log_likelihood(const Evidence& evidence, const StateBatch& states,
                                            std::span<double> out) const {
  constexpr size_t kGrain = 64;  // [guess] poses per task
  check_batch(*body_, states, out);
  const Skeleton& skeleton = body_->skeleton;
  for (const Prepared::View& view : own_evidence<Prepared>(evidence).views) {
    parallel_for(out.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) {
        const std::span pose(states.row(static_cast<Eigen::Index>(n)).data(), skeleton.dofs().size());
        out[n] -= options_.share * 0.5 * view.trust * view.term->cost(skeleton, pose);
      }
    });
  }
}

NormalEquations KeypointLikelihood::linearise(const Evidence& evidence, std::span<const double> pose) const {
  const Eigen::Index D = body_->skeleton.num_dofs();
  NormalEquations equations{0, Eigen::VectorXd::Zero(D), Eigen::MatrixXd::Zero(D, D)};
  for (const Prepared::View& view : own_evidence<Prepared>(evidence).views) {
    equations.energy +=
        view.term->add(body_->skeleton, pose, options_.share * view.trust, equations.gradient, equations.hessian);
  }
  return equations;
}

}  // namespace silpose
