// Presets: TrackerOptions filled in but for body and cameras; and options given by name on top of a preset.
// Threads: functions without state.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

TrackerOptions default_preset();   // online: four hypotheses, fitted
TrackerOptions accurate_preset();  // for recorded clips: eight hypotheses, the whole mesh, smoothed
TrackerOptions thesis_preset();    // two plain particle filters, for root and pose (cormier2019 sect. 2.4)
TrackerOptions plain_preset();     // one plain particle filter for both
TrackerOptions annealed_preset();  // the same, annealed (deutscher2005)

struct Preset {
  std::string name;
  TrackerOptions (*options)();
  std::string_view by_option = "";  // not chosen by its name, but where this option is given
};
// default, accurate, the sampling filters that replace them (named after the options that ask for them), thesis.
const std::vector<Preset>& presets();

// Those that are chosen by name.
std::vector<std::string_view> preset_names();

// A preset by name, with the options that are given. With `particles` or `layers` a fitted preset becomes a sampling
// filter, annealed with more than one layer.
// REQUIRES: values from read_option() or parse_option().
// Errors: throws std::invalid_argument for a name that is no preset, a name that is no option, and what
// refused_option() finds.
TrackerOptions make_tracker_options(std::string_view preset, const GivenOptions& given);

// An option that is given but belongs to the other kind of filter. Values that ask for nothing belong to both.
struct RefusedOption {
  std::string name;
  std::string why;  // "not together with --particles", where `prefix`, before names of options, is "--"
};
std::optional<RefusedOption> refused_option(std::string_view preset, const GivenOptions& given,
                                            std::string_view prefix = "");

// Every option that has a name, as make_tracker_options() takes it.
GivenOptions named_options(const TrackerOptions& options);

// The values that an option has in the presets: "4; accurate: 8".
std::string defaults_text(std::string_view option);

}  // namespace silpose
