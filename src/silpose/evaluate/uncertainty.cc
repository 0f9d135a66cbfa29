#include "silpose/evaluate/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "silpose/base/check.h"

namespace silpose {
namespace {

void check_items(const char* what, std::span<const double> a, size_t other_size) {
  check(!a.empty() && a.size() == other_size, "{}: {} and {} values", what, a.size(), other_size);
  check(std::ranges::all_of(a, [](double value) { return std::isfinite(value); }), "{}: a value is not finite", what);
}

std::vector<size_t> order_of(std::span<const double> values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t i) { return values[i]; });
  return order;
}

// Calls visit(begin, end) for each run of equal values in `order`.
template <class Visit>
void for_each_tie(std::span<const double> values, std::span<const size_t> order, Visit visit) {
  for (size_t begin = 0; begin < order.size();) {
    size_t end = begin + 1;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    visit(begin, end);
    begin = end;
  }
}

// [N] from 1; equal values have the mean of their ranks.
std::vector<double> ranks_of(std::span<const double> values) {
  const std::vector<size_t> order = order_of(values);
  std::vector<double> ranks(values.size());
  for_each_tie(values, order, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) ranks[order[i]] = static_cast<double>(begin + 1 + end) / 2;
  });
  return ranks;
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

double interval_calibration_error(std::span<const double> errors, std::span<const double> deviations) {
  constexpr double kRounding = 1e-9;
  check_items("interval_calibration_error", errors, deviations.size());
  check_items("interval_calibration_error", deviations, errors.size());
  std::vector<double> levels(errors.size());  // of the smallest interval that holds the truth
  for (size_t i = 0; i < errors.size(); ++i) {
    check(deviations[i] >= 0, "interval_calibration_error: a deviation of {}", deviations[i]);
    const double error = std::abs(errors[i]);
    levels[i] = error <= kRounding ? 0 : deviations[i] > 0 ? std::erf(error / deviations[i] / std::numbers::sqrt2) : 1;
  }
  constexpr int kNumLevels = 9;
  double sum = 0;
  for (int k = 1; k <= kNumLevels; ++k) {
    const double level = k / 10.0;
    const auto inside = std::ranges::count_if(levels, [&](double needed) { return needed <= level; });
    sum += std::abs(static_cast<double>(inside) / static_cast<double>(levels.size()) - level);
  }
  return sum / kNumLevels;
}

std::optional<double> rank_correlation(std::span<const double> a, std::span<const double> b) {
  check_items("rank_correlation", a, b.size());
  check_items("rank_correlation", b, a.size());
  const std::vector<double> ranks_a = ranks_of(a), ranks_b = ranks_of(b);
  const double mean = static_cast<double>(a.size() + 1) / 2;
  double products = 0, squares_a = 0, squares_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    products += (ranks_a[i] - mean) * (ranks_b[i] - mean);
    squares_a += (ranks_a[i] - mean) * (ranks_a[i] - mean);
    squares_b += (ranks_b[i] - mean) * (ranks_b[i] - mean);
  }
  if (squares_a == 0 || squares_b == 0) return std::nullopt;
  return products / std::sqrt(squares_a * squares_b);
}

std::optional<double> roc_area(std::span<const double> values, const std::vector<bool>& is_event) {
  check_items("roc_area", values, is_event.size());
  const std::vector<double> ranks = ranks_of(values);
  double rank_sum = 0, num_events = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (is_event[i]) rank_sum += ranks[i], num_events += 1;
  }
  const double num_others = static_cast<double>(values.size()) - num_events;
  if (num_events == 0 || num_others == 0) return std::nullopt;
  return (rank_sum - num_events * (num_events + 1) / 2) / (num_events * num_others);
}

double mean_of_surest(std::span<const double> errors, std::span<const double> uncertainties, double share_kept) {
  check_items("mean_of_surest", errors, uncertainties.size());
  check_items("mean_of_surest", uncertainties, errors.size());
  check(share_kept > 0 && share_kept <= 1, "mean_of_surest: a share of {}", share_kept);
  const std::vector<size_t> order = order_of(uncertainties);
  std::vector<double> sorted(errors.size());
  for_each_tie(uncertainties, order, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += errors[order[i]];
    std::fill(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.begin() + static_cast<std::ptrdiff_t>(end),
              sum / static_cast<double>(end - begin));
  });
  const auto kept = static_cast<size_t>(std::llround(share_kept * static_cast<double>(sorted.size())));
  return mean_of(std::span(sorted).first(std::max<size_t>(kept, 1)));
}

}  // namespace silpose
