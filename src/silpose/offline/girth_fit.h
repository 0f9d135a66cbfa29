// fit_girths(): how thick the subject is, bone by bone, from silhouettes whose poses are known: a search along one
// girth after another, each step to the lowest point of a parabola. Threads: a function without state; uses all cores
// and gives the same result on any number.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "silpose/body/girth.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

struct GirthFit {
  Eigen::VectorXd girths;      // [G] body/girth.h
  Eigen::VectorXd deviations;  // [G] of their uncertainty, all else given
};

// From `start` [G]. `poses` [T] of [D] are of the girths' body; evidence [T].
GirthFit fit_girths(const Girths& girths, const std::vector<PinholeCamera>& cameras,
                    std::span<const CoverageEvidence> evidence, std::span<const Eigen::VectorXd> poses,
                    const Eigen::VectorXd& start, const std::function<bool()>& proceed = {});

}  // namespace silpose
