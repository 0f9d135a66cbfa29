// find_cast_shadow(): the shadow that the subject casts, distinguished from the subject by a property that only shows
// over a larger area: the light is reduced by one and the same factor over the whole of the background's texture. Based
// on: a shadow scales luma and chroma alike (references.bib: horprasert1999); one light, so one factor for all of its
// shadow; grown from where that is certain. Threads: a function without state.
#pragma once

#include "silpose/image/image.h"
#include "silpose/segment/background_model.h"

namespace silpose {

struct CastShadow {
  ByteImage shadow;      // [H, W] not 0 where there is one
  ByteImage looks_like;  // [H, W] where there could be one by its colour, on the floor; includes the shadow
  int floor_row = 0;     // from this row down it is at the height of the subject's feet
};

// Of an image [H, W, 3] in Y, Cr, Cb that is brighter than the background by the factor `gain` (exposure_gain()).
// `differs` [H, W] is not 0 where the image differs from the unshadowed background. REQUIRES: equal sizes.
CastShadow find_cast_shadow(const BackgroundModel& model, const ByteImage& luma_chroma, float gain,
                            const ByteImage& differs);

}  // namespace silpose
