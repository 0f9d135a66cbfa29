#include "figure.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "silpose/base/clock.h"

namespace silpose::bench {
namespace {

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(position);
  const size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace

Figure measure(const Contest& contest, const std::function<void()>& ours, const std::function<void()>& theirs) {
  const auto value_of = [&](const std::function<void()>& run) {
    const Stopwatch stopwatch;
    run();
    const double seconds = stopwatch.seconds();
    return contest.higher_is_better ? contest.value_at_one_second / seconds : contest.value_at_one_second * seconds;
  };
  ours();
  theirs();
  std::vector<double> our_values, their_values;
  for (int round = 0; round < contest.rounds; ++round) {
    our_values.push_back(value_of(ours));
    their_values.push_back(value_of(theirs));
  }
  Figure figure{.value = quantile(our_values, 0.5),
                .unit = contest.unit,
                .peer = contest.peer,
                .peer_value = quantile(their_values, 0.5)};
  figure.ratio = contest.higher_is_better ? figure.value / figure.peer_value : figure.peer_value / figure.value;
  figure.spread = (quantile(our_values, 0.75) - quantile(our_values, 0.25)) / figure.value;
  return figure;
}

void verify(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error("wrong result: " + what);
}

}  // namespace silpose::bench
