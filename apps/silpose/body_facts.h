// What commands report of a body, and how they write one. Threads: the main thread only.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "apps/silpose/command.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"

namespace silpose::app {

nlohmann::ordered_json facts_of(const BodyModel& body);
std::string summary_of(const BodyModel& body);

// Errors: not writable.
Result<Outcome> write_model(const BodyModel& body, const std::string& out);

}  // namespace silpose::app
