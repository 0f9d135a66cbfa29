#include "silpose/image/mask.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "silpose/base/check.h"
#include "silpose/image/mask_count.h"

namespace silpose {
namespace {

void check_equal_sizes(const Mask& a, const Mask& b) {
  check(a.width() == b.width() && a.height() == b.height(), "masks of {}x{} and {}x{} cannot be compared", a.width(),
        a.height(), b.width(), b.height());
}

}  // namespace

Mask::Mask(int width, int height) : width_(width), height_(height), words_per_row_((width + 63) / 64) {
  check(width >= 0 && height >= 0, "Mask: size {}x{}", width, height);
  words_.assign(static_cast<size_t>(words_per_row_) * static_cast<size_t>(height), 0);
}

void Mask::set(int x, int y, bool value) {
  uint64_t& word = row(y)[static_cast<size_t>(x) >> 6];
  const uint64_t bit = uint64_t{1} << (x & 63);
  word = value ? word | bit : word & ~bit;
}

void Mask::clear() { std::ranges::fill(words_, 0); }

int64_t Mask::count() const { return count_set_bits(words_); }

Box Mask::bounding_box() const {
  int x0 = width_, x1 = -1, y0 = height_, y1 = -1;
  for (int y = 0; y < height_; ++y) {
    const auto words = row(y);
    for (int w = 0; w < words_per_row_; ++w) {
      const uint64_t word = words[static_cast<size_t>(w)];
      if (word == 0) continue;
      x0 = std::min(x0, 64 * w + std::countr_zero(word));
      x1 = std::max(x1, 64 * w + 63 - std::countl_zero(word));
      y0 = std::min(y0, y);
      y1 = y;
    }
  }
  return y1 < 0 ? Box{} : Box{x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

int64_t xor_count(const Mask& a, const Mask& b) {
  check_equal_sizes(a, b);
  return count_xor_bits(a.words(), b.words());
}

int64_t and_count(const Mask& a, const Mask& b) {
  check_equal_sizes(a, b);
  return count_and_bits(a.words(), b.words());
}

Mask without(Mask mask, const Mask& removed) {
  check_equal_sizes(mask, removed);
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    const auto out = removed.row(y);
    for (size_t w = 0; w < row.size(); ++w) row[w] &= ~out[w];
  }
  return mask;
}

bool are_adjacent(const Mask& a, const Mask& b) {
  check_equal_sizes(a, b);
  for (int y = 0; y < a.height(); ++y) {
    const auto row = a.row(y), other = b.row(y);
    for (size_t w = 0; w < row.size(); ++w) {
      uint64_t near = row[w] << 1 | row[w] >> 1;
      if (w > 0) near |= row[w - 1] >> 63;
      if (w + 1 < row.size()) near |= row[w + 1] << 63;
      if (y > 0) near |= a.row(y - 1)[w];
      if (y + 1 < a.height()) near |= a.row(y + 1)[w];
      if ((near & other[w]) != 0) return true;
    }
  }
  return false;
}

int64_t or_count(const Mask& a, const Mask& b) {
  check_equal_sizes(a, b);
  return count_or_bits(a.words(), b.words());
}

double intersection_over_union(const Mask& a, const Mask& b) {
  const int64_t either = or_count(a, b);
  return either == 0 ? 1.0 : static_cast<double>(and_count(a, b)) / static_cast<double>(either);
}

Mask mask_from_text(std::string_view text) {
  std::vector<std::string_view> rows;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    const size_t first = line.find_first_not_of(" \t\r");
    const size_t last = line.find_last_not_of(" \t\r");
    if (first != std::string_view::npos) rows.push_back(line.substr(first, last - first + 1));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  Mask mask(rows.empty() ? 0 : static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < mask.height(); ++y) {
    const std::string_view line = rows[static_cast<size_t>(y)];
    check(line.size() == rows[0].size(), "mask_from_text: row {} has {} pixels, row 0 has {}", y, line.size(),
          rows[0].size());
    for (int x = 0; x < mask.width(); ++x) {
      const char pixel = line[static_cast<size_t>(x)];
      check(pixel == '#' || pixel == '.', "mask_from_text: '{}' is neither '#' nor '.'", pixel);
      if (pixel == '#') mask.set(x, y);
    }
  }
  return mask;
}

std::string text_from_mask(const Mask& mask) {
  std::string text;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) text += mask.get(x, y) ? '#' : '.';
    text += '\n';
  }
  return text;
}

Mask mask_from_image(const ByteImage& image, int threshold) {
  check(image.channels() == 1, "mask_from_image: {} channels", image.channels());
  Mask mask(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    const auto bytes = image.row(y);
    const auto words = mask.row(y);
    for (size_t x = 0; x < bytes.size(); ++x) words[x >> 6] |= uint64_t{bytes[x] >= threshold} << (x & 63);
  }
  return mask;
}

// Eight pixels at a time, in one number.
void bytes_from_bits(std::span<const uint64_t> words, std::span<uint8_t> bytes) {
  static_assert(std::endian::native == std::endian::little);
  constexpr uint64_t kEach = 0x0101010101010101, kOwnBit = 0x8040201008040201, kCarry = 0x7f7f7f7f7f7f7f7f;
  for (size_t x = 0; x < bytes.size(); x += 8) {
    const uint64_t own = ((words[x >> 6] >> (x & 63) & 0xff) * kEach) & kOwnBit;
    const uint64_t eight = ((own + kCarry) >> 7 & kEach) * 255;
    std::memcpy(&bytes[x], &eight, std::min<size_t>(8, bytes.size() - x));
  }
}

void bits_from_bytes(std::span<const uint8_t> bytes, std::span<uint64_t> words) {
  constexpr uint64_t kEach = 0x0101010101010101, kLow = 0x7f7f7f7f7f7f7f7f, kGather = 0x0102040810204080;
  std::ranges::fill(words, 0);
  for (size_t x = 0; x < bytes.size(); x += 8) {
    uint64_t eight = 0;
    std::memcpy(&eight, &bytes[x], std::min<size_t>(8, bytes.size() - x));
    const uint64_t set = (((eight & kLow) + kLow) | eight) >> 7 & kEach;
    words[x >> 6] |= (set * kGather >> 56) << (x & 63);
  }
}

ByteImage image_from_mask(const Mask& mask) {
  ByteImage image(mask.width(), mask.height());
  for (int y = 0; y < mask.height(); ++y) {
    const auto words = mask.row(y);
    const auto bytes = image.row(y);
    bytes_from_bits(words, bytes);
  }
  return image;
}

}  // namespace silpose
