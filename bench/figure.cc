#include "figure.h"

#include <algorithm>
#include <stdexcept>

#include "silpose/base/clock.h"

namespace silpose::bench {

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(position);
  const size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

Figure measure(const Contest& contest, const Contestant& ours, std::span<const Contestant> peers) {
  std::vector<const Contestant*> all = {&ours};
  for (const Contestant& peer : peers) all.push_back(&peer);
  for (const Contestant* contestant : all) contestant->run();
  std::vector<std::vector<double>> values(all.size());
  for (int round = 0; round < contest.rounds; ++round) {
    for (size_t i = 0; i < all.size(); ++i) {
      const Stopwatch stopwatch;
      all[i]->run();
      const double seconds = stopwatch.seconds(), amount = all[i]->amount;
      values[i].push_back(contest.higher_is_better ? amount / seconds : seconds / amount);
    }
  }
  Figure figure{.value = quantile(values[0], 0.5), .unit = contest.unit, .peers = {}};
  figure.spread = (quantile(values[0], 0.75) - quantile(values[0], 0.25)) / figure.value;
  for (size_t i = 1; i < all.size(); ++i) {
    const double theirs = quantile(values[i], 0.5);
    figure.peers.push_back({.peer = all[i]->name,
                            .peer_value = theirs,
                            .ratio = contest.higher_is_better ? figure.value / theirs : theirs / figure.value});
  }
  return figure;
}

void verify(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error("wrong result: " + what);
}

}  // namespace silpose::bench
