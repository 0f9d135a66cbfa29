// Drawing on images what was found in them: the outline of a silhouette, and a body's bones. 8-bit B, G, R.
// Anti-aliased; line widths follow the image's height.
// Threads: pure functions.
#pragma once

#include <span>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/render/colour.h"

namespace silpose {

// The borders of a mask, outer ones and holes. REQUIRES: image of 3 channels, of the mask's size.
void draw_outline(ByteImage& image, const Mask& mask, Colour colour = {80, 255, 80});

// The bones of a posed body as lines between landmarks: left ones blue, right ones orange, the others white.
// Bones with an end behind the camera are left out.
void draw_bones(ByteImage& image, const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose);

}  // namespace silpose
