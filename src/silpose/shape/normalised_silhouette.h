// Normalised silhouettes: cropped to the bounding box and stretched to a common size, so that distances between them
// depend neither on the subject's position nor on its apparent size. Both axes are stretched on their own: the common
// size is filled whatever the silhouette's proportions.
// Source: thesis section 2.3.1 (references.bib: cormier2019).
// Threads: pure functions.
#pragma once

#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/shape/window.h"

namespace silpose {

// The window that shows exactly `bounds` on width x height raster pixels. Extents below one thousandth of a pixel are
// widened to that, so that the scale stays finite. REQUIRES: width, height > 0.
[[nodiscard]] Window window_of(const PixelBounds& bounds, int width, int height);
[[nodiscard]] Window window_of(const Box& box, int width, int height);

// The whole of a width x height image, drawn at `scale` (sizes are rounded up).
[[nodiscard]] Window window_of_image(int image_width, int image_height, double scale);

// What `mask` shows in a window: a raster pixel is set when set pixels cover at least half of it. Outside the mask
// nothing is set. A window onto every pixel at scale 1 gives the mask itself.
[[nodiscard]] Mask resample_mask(const Mask& mask, const Window& window);

// How much of each raster pixel set pixels cover: 0, to `whole` where they cover all of it. REQUIRES: whole <= 255.
[[nodiscard]] ByteImage resample_coverage(const Mask& mask, const Window& window, int whole);

// The mask cropped to its bounding box, on width x height pixels; an empty mask gives an empty one.
[[nodiscard]] Mask normalised_silhouette(const Mask& mask, int width, int height);

}  // namespace silpose
