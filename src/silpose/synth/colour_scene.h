// ColourScene: colour images of a SyntheticSequence as a camera would take them: a dressed, shaded body over a
// backdrop, its shadow on the floor, sensor noise that differs in every frame. Drawn frame by frame, when asked.
// Threads: const functions are safe; a frame is the same whichever thread draws it, and in whatever order.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/render/shaded.h"
#include "silpose/synth/backdrop.h"
#include "silpose/synth/scene.h"

namespace silpose {

struct ColourOptions {
  Backdrop backdrop = Backdrop::kTextured;
  double noise_sd = 2;   // of each channel, grey levels
  double shadow = 0.35;  // brightness the floor loses in the shadow, 0 to 1
  uint64_t seed = 1;     // of the backdrop and the noise
};

class ColourScene {
 public:
  // The sequence must outlive the scene. Errors: throws std::invalid_argument for no such camera.
  ColourScene(const SyntheticSequence& sequence, int camera_idx, const ColourOptions& options = {});

  // The empty place, without noise.
  [[nodiscard]] const ByteImage& backdrop() const { return backdrop_; }

  // Frame `frame`, counted from the video's first image; the empty place in the lead-in. [H, W, 3]
  [[nodiscard]] ByteImage draw(int frame) const;

 private:
  const SyntheticSequence* sequence_;
  int camera_idx_;
  ColourOptions options_;
  ByteImage backdrop_;
  std::vector<Eigen::Vector3f> colours_;  // [V]
};

}  // namespace silpose
