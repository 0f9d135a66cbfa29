#include "apps/silpose/body_fit_facts.h"

#include <fmt/format.h>

#include "apps/silpose/run_facts.h"

namespace silpose::app {

nlohmann::ordered_json facts_of(const BodyFit& fit) {
  nlohmann::ordered_json facts;
  if (fit.size) facts["size"] = figure(fit.size->factor, fit.size->deviation);
  for (size_t s = 0; s < fit.names.size(); ++s) {
    facts["lengths_m"][fit.names[s]] = figure(fit.lengths[s], fit.deviations[s]);
  }
  for (const BodyFit::Girth& girth : fit.girths) facts["girths"][girth.name] = figure(girth.share, girth.deviation);
  return facts;
}

std::string summary_of(const BodyFit& fit) {
  std::string what;
  if (fit.size) {
    what = fmt::format("size by the floor, {:+.1f} % (deviation over frames {:.1f} %)", 100 * (fit.size->factor - 1),
                       100 * fit.size->deviation);
  }
  if (!fit.lengths.empty()) {
    what += fmt::format("{}lengths of {} bones and {} girths", what.empty() ? "" : ", ", fit.lengths.size(),
                        fit.girths.size());
  }
  return fmt::format("{}: {:.3f} m, {:.1f} kg", what, fit.body->height_m, fit.body->weight_kg);
}

}  // namespace silpose::app
