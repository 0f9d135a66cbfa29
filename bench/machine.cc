#include "machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <thread>
#include <vector>

#include "figure.h"
#include "silpose/base/clock.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "machine.cc"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight sums that do not wait for each other. Returns the number of multiply-adds.
double multiply_add(size_t rounds, float* sink) {
  const hn::ScalableTag<float> d;
  const auto factor = hn::Set(d, 0.999f), term = hn::Set(d, 0.001f);
  auto a = term, b = term, c = term, e = term, f = term, g = term, h = term, k = term;
  for (size_t i = 0; i < rounds; ++i) {
    a = hn::MulAdd(a, factor, term);
    b = hn::MulAdd(b, factor, term);
    c = hn::MulAdd(c, factor, term);
    e = hn::MulAdd(e, factor, term);
    f = hn::MulAdd(f, factor, term);
    g = hn::MulAdd(g, factor, term);
    h = hn::MulAdd(h, factor, term);
    k = hn::MulAdd(k, factor, term);
  }
  const auto sum = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)), hn::Add(hn::Add(f, g), hn::Add(h, k)));
  *sink = hn::GetLane(sum);
  return static_cast<double>(8 * rounds * hn::Lanes(d));
}

void read_all(const uint64_t* words, size_t num_words, uint64_t* sink) {
  const hn::ScalableTag<uint64_t> d;
  const size_t lanes = hn::Lanes(d);
  auto a = hn::Zero(d), b = a;
  for (size_t i = 0; i + 2 * lanes <= num_words; i += 2 * lanes) {
    a = hn::Xor(a, hn::LoadU(d, words + i));
    b = hn::Xor(b, hn::LoadU(d, words + i + lanes));
  }
  *sink = hn::GetLane(hn::Xor(a, b));
}

}  // namespace silpose::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose::bench {
namespace {

HWY_EXPORT(multiply_add);
HWY_EXPORT(read_all);

// The best of several tries: what else the machine does only takes away.
template <class Run>
double best_seconds(const Run& run) {
  double least = 1e9;
  for (int i = 0; i < 15; ++i) {
    const Stopwatch stopwatch;
    run();
    least = std::min(least, stopwatch.seconds());
  }
  return least;
}

}  // namespace

MachineBounds measure_machine(size_t working_set_bytes) {
  MachineBounds bounds;
  constexpr size_t kRounds = 1 << 20;
  const double chain_s = best_seconds([] {
    uint64_t sum = 0;
    for (size_t i = 0; i < kRounds; ++i) {
      sum += 3;
      asm volatile("" : "+r"(sum));
    }
    keep(sum);
  });
  bounds.clock_hz = kRounds / chain_s;
  double count = 0;
  const double multiply_s = best_seconds([&] {
    float sink = 0;
    count = HWY_DYNAMIC_DISPATCH(multiply_add)(kRounds, &sink);
    keep(sink);
  });
  bounds.multiply_adds_per_s = count / multiply_s;
  const std::vector<uint64_t> words(working_set_bytes / sizeof(uint64_t), 1);
  const size_t repeats = 1 + (size_t{1} << 26) / std::max<size_t>(1, working_set_bytes);
  const double read_s = best_seconds([&] {
    uint64_t sink = 0;
    for (size_t i = 0; i < repeats; ++i) {
      HWY_DYNAMIC_DISPATCH(read_all)(words.data(), words.size(), &sink);
      keep(sink);
    }
  });
  bounds.bytes_per_s = static_cast<double>(repeats * words.size() * sizeof(uint64_t)) / read_s;
  return bounds;
}

std::string machine_name() {
  std::string model = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    model = line.substr(line.find(':') + 2);
    break;
  }
  return fmt::format("{}, {} threads, {}", model, std::thread::hardware_concurrency(),
                     hwy::TargetName(hwy::SupportedTargets() & -hwy::SupportedTargets()));
}

}  // namespace silpose::bench
#endif  // HWY_ONCE
