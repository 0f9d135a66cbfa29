// silpose.h: what a program that tracks a person includes.
// The pieces have headers of their own; see ARCHITECTURE.md for which module does what.
#pragma once

#include "silpose/body/body_model.h"
#include "silpose/exchange/tables.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/human/human.h"
#include "silpose/image/image_file.h"
#include "silpose/image/memory_source.h"
#include "silpose/render/silhouette.h"
#include "silpose/segment/make_segmenter.h"
#include "silpose/session/session.h"
#include "silpose/track/tracker.h"
#include "silpose/track/tracker_presets.h"
#include "silpose/video/video.h"
