// BackgroundOrigin: what a background is learned from. Threads: values, functions without state.
#pragma once

#include <string>
#include <variant>

#include "silpose/base/result.h"

namespace silpose {

struct BackgroundOfClip {};  // the whole clip; of a live camera online
struct BackgroundOnline {
  bool knn = false;  // OpenCV's mixture: KNN (references.bib: zivkovic2006), otherwise MOG2 (zivkovic2004)
};
inline constexpr double kLongestLeadIn_s = 1e6;  // [guess] in effect unlimited
struct BackgroundLeadIn {
  double seconds = 1;  // of the clip's beginning, in which the subject is not there; up to kLongestLeadIn_s
};
struct BackgroundPlate {
  std::string path;  // a video or an image of the empty scene
};
using BackgroundOrigin = std::variant<BackgroundOfClip, BackgroundOnline, BackgroundLeadIn, BackgroundPlate>;

// "auto", "online", "online:knn", "lead-in:SECONDS", or a path: as commands and experiment files name it. Errors: no
// positive number of seconds.
Result<BackgroundOrigin> background_origin_of(const std::string& text);
std::string text_of(const BackgroundOrigin& origin);

}  // namespace silpose
