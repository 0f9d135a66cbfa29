// The levels of detail that a body is kept with, so that no command has to make them anew.
// Threads: the main thread only; works on all cores.
#pragma once

#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"

namespace silpose::app {

// Makes the levels that tracking asks for, each with how much of its silhouettes it shares with the whole body's; in
// place of those that the body has.
void add_levels(BodyModel& body, Console& console);

// The body's own level, the coarsest that shares so much, as coarsest_level(). Errors: none does, or it has none at
// all.
Result<const BodyLevel*> choose_level(const BodyModel& body, double mean_iou);

}  // namespace silpose::app
