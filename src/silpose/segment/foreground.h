// ForegroundFinder: the pixels that the background does not explain, neither as it is nor darkened by a shadow.
// Based on: a chi-square distance with a shadow alternative of scaled luma and chroma (references.bib: horprasert1999),
// regularised by mean-field steps over contrast-sensitive ties between neighbours (references.bib: boykov2001).
// Threads: one thread per finder (it keeps scratch, which carries nothing from image to image); works on all cores
// itself.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/segment/background_model.h"
#include "silpose/segment/cast_shadow.h"

namespace silpose {

class ForegroundFinder {
 public:
  explicit ForegroundFinder(BackgroundModel model);

  // [H, W] of an image [H, W, 3] in Y, Cr, Cb; `others` [H, W]: log odds by other evidence than colour, such as
  // depth. REQUIRES: the model's size.
  Mask find(const ByteImage& luma_chroma, const Image<float>* others = nullptr);

  // [H, W] The certainty of the last find(), 255: certain. Pixels that only a shadow explains are uncertain, whichever
  // way they were decided.
  [[nodiscard]] ByteImage confidence(const Mask& found) const;

  [[nodiscard]] const BackgroundModel& model() const { return model_; }

 private:
  void compare_texture(const ByteImage& luma_chroma);
  void weigh_evidence(const ByteImage& luma_chroma, float gain);
  void take_out_shadow(const ByteImage& luma_chroma, float gain);
  void add_evidence(const Image<float>& others);
  void choose_blocks();
  void tie_neighbours(const ByteImage& luma_chroma);
  void smooth_beliefs();
  void keep_enclosed_shadows(Mask& mask) const;
  template <class Body>
  void for_each_run(const Body& body) const;  // body(x begin, x end, y) over the chosen blocks

  BackgroundModel model_;
  size_t stride_ = 0;  // of the fields below: one pixel more than the image on every side
  int blocks_x_ = 0, blocks_y_ = 0;
  std::vector<float> inverse_noise_;  // [3, H, W] 1 / variance
  ByteImage window_back_;             // [H, W, 3] mean of the median around each pixel
  std::vector<float> texture_;        // [H, W] what a scaled background leaves of the luma around, as variance
  ByteImage differs_;                 // [H, W] would be foreground if there were no shadows
  CastShadow cast_;                   // of the last image
  std::vector<uint8_t> chosen_;       // [blocks_y, blocks_x] where anything may be foreground
  std::vector<float> evidence_, belief_, next_;               // positive speaks for foreground
  std::vector<float> right_, down_, down_right_, down_left_;  // ties to the neighbour there; 0 between images
};

// How much brighter the whole image is than the background: the median ratio of luma. 1 is no change.
float exposure_gain(const BackgroundModel& model, const ByteImage& luma_chroma);

}  // namespace silpose
