// find_cast_shadow(): the shadow that the subject casts, told from the subject by what only a larger piece of the
// picture shows: that the light is less by one and the same factor, over whatever the background's texture is. Based
// on: a shadow scales luma and chroma alike (references.bib: horprasert1999); one light, so one factor for all of its
// shadow; grown from where that is sure. Threads: a function without state.
#pragma once

#include "silpose/image/image.h"
#include "silpose/segment/background_model.h"

namespace silpose {

struct CastShadow {
  ByteImage shadow;      // [H, W] not 0 where there is one
  ByteImage looks_like;  // [H, W] where there could be one by its colour, on the floor; the shadow among it
  int floor_row = 0;     // from this row on it lies at the height of the subject's feet
};

// Of a picture [H, W, 3] in Y, Cr, Cb that is brighter than the background by the factor `gain` (exposure_gain()).
// `differs` [H, W] is not 0 where the picture is not the background as it is. REQUIRES: equal sizes.
CastShadow find_cast_shadow(const BackgroundModel& model, const ByteImage& luma_chroma, float gain,
                            const ByteImage& differs);

}  // namespace silpose
