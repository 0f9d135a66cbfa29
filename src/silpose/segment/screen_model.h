// ScreenModel: what a coloured screen (chroma key) looks like at every pixel without a subject in front of it, and
// where it ends. A pixel is screen where its colour difference is the screen's there, scaled with its brightness: a
// shadow on the screen stays screen, neutral or skin-coloured spill stays subject.
// Based on: colour-difference keying (references.bib: smith1996) on Cr and Cb; the model is a normalised convolution
// (references.bib: knutsson1993) of what was seen of the screen over the clip; edges follow
// the luma as a guided filter's do (references.bib: he2013).
// Threads: values; the functions may be called from any thread and work on all cores themselves.
#pragma once

#include <optional>

#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/segment/background_model.h"
#include "silpose/segment/key_colour.h"

namespace silpose {

struct ScreenModel {
  KeyColour key{};       // the screen's mean colour, as filmed
  Image<float> project;  // [H, W, 3] 1 / Y; Cr / |C|^2 and Cb / |C|^2 of the lit screen there, C = (Cr, Cb) - 128
  Mask inside;           // [H, W] the convex hull of what is screen in any image
  double filled = 0;     // the part of it that is screen in any image

  [[nodiscard]] int width() const { return inside.width(); }
  [[nodiscard]] int height() const { return inside.height(); }
};

// From images spread over the clip, which may show the subject; key and `keep` as for dominant_colour().
// REQUIRES: at least one sample, equal sizes.
// Errors: no colour (or not the key's) covers enough of the image to be a screen.
Result<ScreenModel> learn_screen(const BackgroundSamples& samples, const std::optional<KeyColour>& key,
                                 const std::optional<Mask>& keep = {});

// [H, W] set where an image [H, W, 3] in Y, Cr, Cb does not show the screen: more than half opaque at soft edges.
// REQUIRES: the model's size.
Mask find_before_screen(const ScreenModel& model, const ByteImage& luma_chroma);

}  // namespace silpose
