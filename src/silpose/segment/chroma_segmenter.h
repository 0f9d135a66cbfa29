// The segmenter for a coloured screen: what is in front of it is the subject. Made by make_segmenter().
// Threads: one thread per segmenter.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "silpose/segment/clean_up.h"
#include "silpose/segment/screen_model.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// What lies outside the screen is cut away, unless a garbage mask says what to cut.
std::unique_ptr<Segmenter> make_chroma_segmenter(ScreenModel model, const std::string& input,
                                                 const CleanUpOptions& clean_up);

}  // namespace silpose
