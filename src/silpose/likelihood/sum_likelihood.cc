#include "silpose/likelihood/sum_likelihood.h"

#include <algorithm>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {

struct SumLikelihood::Prepared final : Evidence {
  std::vector<std::unique_ptr<const Evidence>> of_parts;
};

SumLikelihood::SumLikelihood(std::vector<std::shared_ptr<const PoseLikelihood>> parts) : parts_(std::move(parts)) {
  check(!parts_.empty(), "SumLikelihood: nothing to sum");
  for (const auto& part : parts_) {
    check(part != nullptr, "SumLikelihood: a part is missing");
    check(part->body().skeleton.num_dofs() == body().skeleton.num_dofs(), "SumLikelihood: bodies of {} and {} DOF",
          part->body().skeleton.num_dofs(), body().skeleton.num_dofs());
  }
}

std::unique_ptr<const PoseLikelihood::Evidence> SumLikelihood::prepare(
    std::span<const Observation> observations) const {
  auto prepared = std::make_unique<Prepared>();
  for (const auto& part : parts_) prepared->of_parts.push_back(part->prepare(observations));
  return prepared;
}

void SumLikelihood::add_log_likelihood(const Evidence& evidence, const StateBatch& states,
                                       std::span<double> out) const {
  const auto& of_parts = own_evidence<Prepared>(evidence).of_parts;
  check(of_parts.size() == parts_.size(), "SumLikelihood: evidence of {} parts for {}", of_parts.size(), parts_.size());
  for (size_t i = 0; i < parts_.size(); ++i) parts_[i]->add_log_likelihood(*of_parts[i], states, out);
}

bool SumLikelihood::can_linearise() const {
  return std::ranges::all_of(parts_, [](const auto& part) { return part->can_linearise(); });
}

NormalEquations SumLikelihood::linearise(const Evidence& evidence, std::span<const double> pose) const {
  const auto& of_parts = own_evidence<Prepared>(evidence).of_parts;
  check(of_parts.size() == parts_.size(), "SumLikelihood: evidence of {} parts for {}", of_parts.size(), parts_.size());
  NormalEquations sum = parts_.front()->linearise(*of_parts.front(), pose);
  for (size_t i = 1; i < parts_.size(); ++i) {
    const NormalEquations part = parts_[i]->linearise(*of_parts[i], pose);
    sum.energy += part.energy;
    sum.gradient += part.gradient;
    sum.hessian += part.hessian;
  }
  return sum;
}

}  // namespace silpose
