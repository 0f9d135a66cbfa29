// The page that make_report fills: markup, style and the script that draws the curves. Three places are filled in:
// @TITLE@, @VIDEO@ (the source of the video element) and @DATA@ (JSON).
#pragma once

#include <string_view>

namespace silpose {

extern const std::string_view kPageTemplate;

}  // namespace silpose
