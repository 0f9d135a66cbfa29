// The evidence of each single pixel of a row for being foreground, before its neighbours are considered: the two passes
// over all pixels that ForegroundFinder makes, by Highway for the machine's vector registers.
// Threads: functions without state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace silpose {

// Texture is compared in windows of this many pixels on either side. Small ones: a shadow on the floor is seen at a low
// angle and is a narrow strip. [guess]
inline constexpr int kTextureReach = 1;

// Rows of images [W, 3] in Y, Cr, Cb, of those within kTextureReach that there are.
struct TextureRows {
  static constexpr size_t kMost = 2 * kTextureReach + 1;
  std::array<const uint8_t*, kMost> seen, background;
  size_t count = 0;
};

// texture [W] = what a scaled background leaves of the luma in the window around each pixel, as variance. `sums`:
// scratch, kept from row to row by one thread.
void compare_texture_row(const TextureRows& rows, size_t width, int32_t* sums, float* texture);
// How many numbers `sums` has.
size_t texture_sums_size(size_t width);

// One row [W] of an image and of its background, both [W, 3] in Y, Cr, Cb, and of their means around each pixel.
struct EvidenceRow {
  const uint8_t *seen, *background, *seen_around, *background_around;
  std::array<const float*, 3> inverse_noise;             // of each channel
  std::array<const float*, TextureRows::kMost> texture;  // of this row and its neighbours
  float gain = 1;                                        // of the background's light
  size_t width = 0;
};

// evidence [W]: half the chi-square distance of what explains the pixel best, the background as it is or in shadow,
// above the threshold, bounded; differs [W]: 1 where it would be foreground if there were no shadows. `least`: scratch
// [W + 2 kTextureReach].
void weigh_evidence_row(const EvidenceRow& row, float* least, float* evidence, uint8_t* differs);

// Evidence against foreground is bounded, so that neighbours can outvote it. [guess]
inline constexpr float kMostAgainst = 4;

}  // namespace silpose
