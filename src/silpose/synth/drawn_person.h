// draw_person(): a person of a body's stature with other proportions: bones and girths differ from the body's as much
// as people's do (body/stretchable.h, body/girth.h). Threads: a function without state.
#pragma once

#include <cstdint>

#include "silpose/body/body_model.h"

namespace silpose {

// `body` has a closed mesh. The same seed draws the same person.
BodyModel draw_person(const BodyModel& body, uint64_t seed);

}  // namespace silpose
