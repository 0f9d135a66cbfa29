// silpose_bench [--json] [--rounds N] [NAME...]: what is measured against peers in the same run; without names:
// everything. silpose_bench --curves DIR: what a likelihood costs against what it is made of.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benches.h"
#include "curves.h"
#include "figure.h"

namespace {

using silpose::bench::Figure;
using silpose::bench::PeerFigure;

struct Entry {
  const char* name;
  Figure (*run)(int rounds);
};
constexpr std::array kEntries = {
    Entry{"likelihood_full", silpose::bench::likelihood_full},
    Entry{"likelihood_lod", silpose::bench::likelihood_lod},
    Entry{"likelihood_coverage", silpose::bench::likelihood_coverage},
    Entry{"depth_full", silpose::bench::depth_full},
    Entry{"scaling_2_threads", silpose::bench::scaling_2_threads},
    Entry{"xor_128_us", silpose::bench::xor_128_us},
    Entry{"xor_256_us", silpose::bench::xor_256_us},
    Entry{"metric_surface_s", silpose::bench::metric_surface_s},
    Entry{"track_vga_fps", silpose::bench::track_vga_fps},
    Entry{"track_vga_particles_fps", silpose::bench::track_vga_particles_fps},
    Entry{"fit_step_us", silpose::bench::fit_step_us},
    Entry{"fit_step_full_us", silpose::bench::fit_step_full_us},
    Entry{"fit_energy_us", silpose::bench::fit_energy_us},
};

nlohmann::ordered_json json_of(const PeerFigure& peer) {
  return {{"peer", peer.peer},
          {"peer_value", peer.peer_value},
          {"ratio", peer.ratio},
          {"processor_ratio", peer.processor_ratio}};
}

// The main peer's figures are next to ours (null without any), the other peers' in a list.
nlohmann::ordered_json json_of(const Figure& figure) {
  nlohmann::ordered_json json = {{"value", figure.value}, {"unit", figure.unit}};
  if (figure.peers.empty()) {
    json.update({{"peer", nullptr}, {"peer_value", nullptr}, {"ratio", nullptr}, {"processor_ratio", nullptr}});
  } else {
    json.update(json_of(figure.peers.front()));
  }
  json["spread"] = figure.spread;
  for (size_t i = 1; i < figure.peers.size(); ++i) json["others"].push_back(json_of(figure.peers[i]));
  return json;
}

std::string text_of(const Figure& figure) {
  std::string text = fmt::format("{:>12.4g} {:<8} spread {:.1f} %", figure.value, figure.unit, 100 * figure.spread);
  for (const PeerFigure& peer : figure.peers) {
    text += fmt::format("\n{:>31.4g} {:<8} {:.2f} x {}", peer.peer_value, figure.unit, peer.ratio, peer.peer);
    if (!std::isnan(peer.processor_ratio)) text += fmt::format(" ({:.2f} x by processor time)", peer.processor_ratio);
  }
  return text;
}

int fail(const std::string& message, bool as_json) {
  if (as_json) fmt::print("{}\n", nlohmann::json{{"error", message}}.dump());
  fmt::print(stderr, "silpose_bench: {}\n", message);
  return 1;
}

int run(const std::vector<std::string>& names, int rounds, bool as_json) {
  nlohmann::ordered_json report = nlohmann::ordered_json::object();
  for (const Entry& entry : kEntries) {
    if (!names.empty() && std::ranges::find(names, entry.name) == names.end()) continue;
    try {
      const Figure figure = entry.run(rounds);
      report[entry.name] = json_of(figure);
      if (!as_json) fmt::print("{:<18} {}\n", entry.name, text_of(figure));
    } catch (const std::exception& failure) {
      return fail(fmt::format("{}: {}", entry.name, failure.what()), as_json);
    }
  }
  if (as_json) fmt::print("{}\n", report.dump(2));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What silpose does, timed next to peers in the same run. Without names: everything.", "silpose_bench");
  bool as_json = false;
  int rounds = 15;
  std::string curves;
  std::vector<std::string> names, known;
  for (const Entry& entry : kEntries) known.emplace_back(entry.name);
  app.add_flag("--json", as_json, "One JSON object on standard output");
  app.add_option("--rounds", rounds, "All take turns this many times; medians are reported")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--curves", curves,
                 "Write what a likelihood costs against triangles, window and particles to a folder");
  app.add_option("NAME", names, fmt::format("{}", fmt::join(known, ", ")))->check(CLI::IsMember(known));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& wrong) {
    fail(wrong.what(), as_json);
    return 2;
  }
  if (curves.empty()) return run(names, rounds, as_json);
  try {
    silpose::bench::write_curves(curves, rounds);
    return 0;
  } catch (const std::exception& failure) {
    return fail(failure.what(), as_json);
  }
}
