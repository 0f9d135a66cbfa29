// StateBatch: the states of N particles, one row each. Filters know nothing about bodies: a row is D numbers.
// Threads: a value.
#pragma once

#include <Eigen/Core>

namespace silpose {

// [N, D] row-major.
using StateBatch = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace silpose
