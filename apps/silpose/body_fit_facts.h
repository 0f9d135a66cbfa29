// What commands report about a body that was fitted to its subject. Threads: the main thread only.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "silpose/offline/body_fit.h"

namespace silpose::app {

// {"lengths_m": {"right_shin_length": {mean, std}, ...}, "girths": {...}, "size": {...}}: what was fitted of these.
nlohmann::ordered_json facts_of(const BodyFit& fit);

// One line for people: "lengths of 12 bones and 12 girths: 1.770 m, 71.2 kg".
std::string summary_of(const BodyFit& fit);

}  // namespace silpose::app
