// Which joint of a capture skeleton corresponds to which part of ours, by its name.
// Threads: a function without state.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace silpose {

// The joint of a clip (index into `names`) that corresponds to one of ours: "root", "head", "left_thigh", ...
// Knows the names of CMU, Mixamo, MakeHuman, Xsens and common exporters, whatever their case, prefix and separators.
// Besides our joint names, `part` may be "neck", "left_toe", "right_toe", "left_finger", "right_finger".
std::optional<int> find_part(const std::vector<std::string>& names, std::string_view part);

}  // namespace silpose
