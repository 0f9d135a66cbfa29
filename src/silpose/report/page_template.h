// The page that make_report fills: page/page.html with its style and scripts inside, made into C++ by page/embed.cmake.
// Four placeholders are to be filled in: @TITLE@ and @HEADING@ (the page's title), @VIDEO@ (the source of the video
// element) and @DATA@ (report_data.h).
#pragma once

#include <string_view>

namespace silpose {

extern const std::string_view kPageTemplate;

}  // namespace silpose
