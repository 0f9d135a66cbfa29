// silpose model fit: the subject's own body, from clips. Threads: the main thread only.
#pragma once

#include "apps/silpose/command.h"

namespace silpose::app {

Command add_model_fit(CLI::App& model, const CommonOptions& common);

}  // namespace silpose::app
