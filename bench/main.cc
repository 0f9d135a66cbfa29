// silpose_bench [--json] [NAME...]: what is measured against a peer in the same run. Without names: everything.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "figure.h"
#include "render_bench.h"

namespace {

using silpose::bench::Figure;

struct Entry {
  const char* name;
  Figure (*run)();
};
constexpr std::array kEntries = {
    Entry{"likelihood_full", silpose::bench::likelihood_full},
    Entry{"likelihood_lod", silpose::bench::likelihood_lod},
    Entry{"xor_128_us", silpose::bench::xor_128_us},
    Entry{"xor_256_us", silpose::bench::xor_256_us},
};

}  // namespace

int main(int argc, char** argv) {
  bool as_json = false;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--json") {
      as_json = true;
    } else if (std::ranges::any_of(kEntries, [&](const Entry& entry) { return entry.name == argument; })) {
      names.push_back(argument);
    } else {
      fmt::print(stderr, "silpose_bench: no benchmark '{}'; there are:", argument);
      for (const Entry& entry : kEntries) fmt::print(stderr, " {}", entry.name);
      fmt::print(stderr, "\n");
      return 2;
    }
  }
  nlohmann::ordered_json report = nlohmann::ordered_json::object();
  for (const Entry& entry : kEntries) {
    if (!names.empty() && std::ranges::find(names, entry.name) == names.end()) continue;
    try {
      const Figure figure = entry.run();
      report[entry.name] = {{"value", figure.value},           {"unit", figure.unit},   {"peer", figure.peer},
                            {"peer_value", figure.peer_value}, {"ratio", figure.ratio}, {"spread", figure.spread}};
      if (!as_json) {
        fmt::print("{:<18} {:>12.4g} {:<8} {:>8.2f} x {} ({:.4g}); spread {:.1f} %\n", entry.name, figure.value,
                   figure.unit, figure.ratio, figure.peer, figure.peer_value, 100 * figure.spread);
      }
    } catch (const std::exception& failure) {
      if (as_json)
        fmt::print("{}\n", nlohmann::json{{"error", fmt::format("{}: {}", entry.name, failure.what())}}.dump());
      fmt::print(stderr, "silpose_bench: {}: {}\n", entry.name, failure.what());
      return 1;
    }
  }
  if (as_json) fmt::print("{}\n", report.dump(2));
  return 0;
}
