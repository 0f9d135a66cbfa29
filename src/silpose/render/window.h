// Window is what a silhouette is drawn into; shape, one floor below, resamples observed masks into the same windows.
#pragma once

#include "silpose/shape/window.h"  // IWYU pragma: export
