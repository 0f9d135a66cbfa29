// `silpose track --each`: every VIDEO is a clip of its own, with its result in DIR/NAME. One that fails does not stop
// the others.
// Threads: the main thread only.
#pragma once

#include <functional>

#include "apps/silpose/command.h"
#include "apps/silpose/console.h"
#include "apps/silpose/track_options.h"
#include "silpose/base/result.h"

namespace silpose::app {

// `track` gets the options of one clip, one after another; with options.resume those that have a result already are
// left out. Failures are reported when they occur, and once more at the end. Throws UsageError for clips of one name,
// and for options that belong to one clip of several cameras.
Result<Outcome> track_each(const TrackOptions& options, Console& console,
                           const std::function<Result<Outcome>(const TrackOptions&)>& track);

}  // namespace silpose::app
