// Plate: what is behind a subject whose mask is known in some pictures of a clip. Based on: the temporal median of what
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

// Masks are not trusted at their edges: each is grown by 4 % of its size first. A picture with an empty mask is
// ignored: whether it is free is unknown. Shapes: pictures [H, W, 3] in Y, Cr, Cb, one mask [H, W] each.
// REQUIRES: at least one picture; equal sizes.
Plate learn_plate(const std::vector<ByteImage>& pictures, const std::vector<Mask>& subjects);

}  // namespace silpose
