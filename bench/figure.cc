#include "figure.h"

#include <sys/resource.h>

#include <algorithm>
#include <stdexcept>

#include "silpose/base/clock.h"

namespace silpose::bench {
namespace {

// Of this process and of those it started and waited for.
double processor_seconds() {
  double seconds = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      seconds += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return seconds;
}

}  // namespace

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
  std::vector<std::vector<double>> values(all.size()), processor(all.size());
  for (int round = 0; round < contest.rounds; ++round) {
    for (size_t i = 0; i < all.size(); ++i) {
      const double before = processor_seconds();
      const Stopwatch stopwatch;
      all[i]->run();
      const double seconds = stopwatch.seconds(), amount = all[i]->amount;
      processor[i].push_back((processor_seconds() - before) / amount);
      values[i].push_back(contest.higher_is_better ? amount / seconds : seconds / amount);
    }
  }
  Figure figure{.value = quantile(values[0], 0.5), .unit = contest.unit, .peers = {}};
  figure.spread = (quantile(values[0], 0.75) - quantile(values[0], 0.25)) / figure.value;
  for (size_t i = 1; i < all.size(); ++i) {
    const double theirs = quantile(values[i], 0.5);
    figure.peers.push_back({.peer = all[i]->name,
                            .peer_value = theirs,
                            .ratio = contest.higher_is_better ? figure.value / theirs : theirs / figure.value,
                            .processor_ratio = quantile(processor[i], 0.5) / quantile(processor[0], 0.5)});
  }
  return figure;
}

void verify(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error("wrong result: " + what);
}

}  // namespace silpose::bench
