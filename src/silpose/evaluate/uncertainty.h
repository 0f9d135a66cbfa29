// Uncertainty: how well claimed standard deviations predict the errors. Their calibration (whether an interval contains
// the truth as often as claimed), their order (whether larger errors are claimed to be larger), and what is gained by
// dropping the least certain frames.
// Based on: expected calibration error of quantiles (references.bib: kuleshov2018); rank correlation (spearman1904);
// area under the receiver operating characteristic as a rank sum, ties counted half (hanley1982); risk and coverage
// (geifman2017).
// Threads: pure functions. All of them throw std::invalid_argument for spans of unequal length, for none, and for
// values that are not finite.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace silpose {

// Shapes: errors (signed or not) and their claimed deviations [N], in the same unit. Mean over the nominal levels 0.1,
// 0.2, ..., 0.9 of |share of errors inside the Gaussian's central interval of that level - level|: 0 is calibrated; 0.5
// is reached where all are inside, or none is. An error that is rounding alone (1e-9) is inside whatever is claimed.
[[nodiscard]] double interval_calibration_error(std::span<const double> errors, std::span<const double> deviations);

// Spearman's rank correlation of [N] pairs, in [-1, 1]; equal values share the mean of their ranks. Nothing where
// either side has one value only.
[[nodiscard]] std::optional<double> rank_correlation(std::span<const double> a, std::span<const double> b);

// How often a value that belongs to an event is above one that does not, equal ones counted half: 1 where the values
// separate them, 0.5 where the values are uninformative. Shapes: [N] each. Nothing where all are events, or none is.
[[nodiscard]] std::optional<double> roc_area(std::span<const double> values, const std::vector<bool>& is_event);

// Mean error of the given share (0, 1] of items that are claimed to be most certain, one at least: a point of the
// risk-coverage curve. Where some items of equal uncertainty are kept and some are not, each counts with the mean of
// all of these, so that the order of the items does not matter. Shapes: [N] each.
[[nodiscard]] double mean_of_surest(std::span<const double> errors, std::span<const double> uncertainties,
                                    double share_kept);

}  // namespace silpose
