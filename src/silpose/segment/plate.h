// Plate: what is behind a subject whose mask is known in some images of a clip. Based on: the temporal median of what
// the subject leaves free.
// Threads: a value; the function may be called from any thread.
#pragma once

#include <vector>

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

struct Plate {
  ByteImage colours;  // [H, W, 3] Y, Cr, Cb
  Mask known;         // [H, W] where it was seen free often enough
};

// Masks are not trusted at their edges: each is grown by 4 % of its size first. An image with an empty mask is
// ignored: whether it is free is unknown. Shapes: images [H, W, 3] in Y, Cr, Cb, one mask [H, W] each.
// REQUIRES: at least one image; equal sizes.
Plate learn_plate(const std::vector<ByteImage>& images, const std::vector<Mask>& subjects);

}  // namespace silpose
