// The levels of detail that are stored with a body, so that no command has to rebuild them.
// Threads: functions without state; work on all cores.
#pragma once

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"

namespace silpose {

// Makes the levels that tracking requests, each with the overlap of its silhouettes with the whole body's; replaces
// those that the body has.
void add_levels(BodyModel& body);

// The coarsest of the body's own levels with at least that overlap, as coarsest_level(). Errors: none does, or it has
// none at all.
Result<const BodyLevel*> choose_level(const BodyModel& body, double mean_iou);

}  // namespace silpose
