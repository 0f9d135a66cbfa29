// Mask: a binary image, one bit per pixel, and its counting kernels. A silhouette is a Mask.
// Bit x of row y is bit (x % 64) of word (x / 64) of that row; bits beyond the width are always 0.
// Threads: a value; const functions are safe.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/image/image.h"

namespace silpose {

// Pixels [x, x + width) x [y, y + height).
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  bool operator==(const Box&) const = default;
};

class Mask {
 public:
  Mask() = default;
  Mask(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int words_per_row() const { return words_per_row_; }

  [[nodiscard]] bool get(int x, int y) const { return (row(y)[static_cast<size_t>(x) >> 6] >> (x & 63)) & 1u; }
  void set(int x, int y, bool value = true);

  // [words_per_row] REQUIRES: 0 <= y < height. Writers leave the bits beyond the width 0.
  std::span<uint64_t> row(int y) {
    return std::span(words_).subspan(static_cast<size_t>(y) * words_per_row_, words_per_row_);
  }
  [[nodiscard]] std::span<const uint64_t> row(int y) const {
    return std::span(words_).subspan(static_cast<size_t>(y) * words_per_row_, words_per_row_);
  }
  // All rows, [height x words_per_row].
  [[nodiscard]] std::span<const uint64_t> words() const { return words_; }
  void clear();

  // Number of set pixels.
  [[nodiscard]] int64_t count() const;

  // Smallest box around the set pixels; empty when there is none.
  [[nodiscard]] Box bounding_box() const;

  bool operator==(const Mask&) const = default;

 private:
  int width_ = 0, height_ = 0, words_per_row_ = 0;
  std::vector<uint64_t> words_;
};

// Pixels in which two masks differ, and those set in both / in either. REQUIRES: equal sizes.
int64_t xor_count(const Mask& a, const Mask& b);
int64_t and_count(const Mask& a, const Mask& b);
int64_t or_count(const Mask& a, const Mask& b);

// The pixels of `mask` that `removed` does not have. REQUIRES: equal sizes.
Mask without(Mask mask, const Mask& removed);

// Whether a pixel of one is next to one of the other, above, below, left or right. REQUIRES: equal sizes.
bool are_adjacent(const Mask& a, const Mask& b);

// Intersection over union; 1 when both are empty. REQUIRES: equal sizes.
double intersection_over_union(const Mask& a, const Mask& b);

// A mask typed as an image: rows separated by newlines, '#' set, '.' not; blanks around rows and empty rows are
// skipped. For tests and messages. Errors: throws std::invalid_argument for other characters or ragged rows.
Mask mask_from_text(std::string_view text);
std::string text_from_mask(const Mask& mask);

// One row of a mask as bytes, 255 where it is set and 0 elsewhere; and back, set where a byte is not 0. Bits beyond the
// bytes become 0. REQUIRES: words for all bytes.
void bytes_from_bits(std::span<const uint64_t> words, std::span<uint8_t> bytes);
void bits_from_bytes(std::span<const uint8_t> bytes, std::span<uint64_t> words);

// One-channel bytes: set where >= threshold; and back, 0 or 255.
Mask mask_from_image(const ByteImage& image, int threshold = 128);
ByteImage image_from_mask(const Mask& mask);

}  // namespace silpose
