// refine_edge(): where a mask ends, decided again from the image and from what is behind the subject.
// Based on: matting in front of a known background: how far a pixel lies from the background's colour towards the
// subject's, both as they are near it (references.bib: smith1996). It runs twice: if the mask was too wide, the second
// pass has better estimates of the colours.
// Threads: functions without state.
#pragma once

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

struct EdgeMatte {
  Mask mask;             // [H, W]
  ByteImage confidence;  // [H, W] 255: certain; less in the band, where the images are inconclusive, or disagree
                         // with the mask that was given
};

// Only pixels in a band along the mask's edge, 2 % of the subject's size wide on either side, are decided again, and
// only where `known` is set (absent: everywhere). Shapes: mask [H, W], image and background [H, W, 3] in Y, Cr, Cb.
// REQUIRES: equal sizes.
EdgeMatte refine_edge(const Mask& mask, const ByteImage& luma_chroma, const ByteImage& background,
                      const Mask* known = nullptr);

}  // namespace silpose
