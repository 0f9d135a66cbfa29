#include "silpose/segment/foreground_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"

namespace silpose {
namespace {

constexpr size_t kWidths[] = {1, 2, 3, 7, 16, 17, 61, 130};  // shorter and longer than a vector, and no multiple of it

std::vector<uint8_t> random_row(size_t width, Rng& rng, const std::vector<uint8_t>* near = nullptr) {
  std::vector<uint8_t> row(3 * width);
  for (size_t i = 0; i < row.size(); ++i) {
    row[i] = near == nullptr ? static_cast<uint8_t>(rng.index(256))
                             : static_cast<uint8_t>(std::clamp((*near)[i] + 6 * rng.normal(), 0.0, 255.0));
  }
  return row;
}

// The variance that a scaled background leaves, pixel by pixel.
double texture_at(const TextureRows& rows, size_t width, size_t x) {
  double ss = 0, sb = 0, bb = 0, count = 0;
  for (size_t r = 0; r < rows.count; ++r) {
    for (size_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, width - 1); ++u) {
      const double s = rows.seen[r][3 * u], b = rows.background[r][3 * u];
      ss += s * s;
      sb += s * b;
      bb += b * b;
      ++count;
    }
  }
  return (ss - sb * sb / std::max(bb, 1.0)) / count;
}

TEST(ForegroundEvidence, TextureIsWhatAScaledBackgroundLeaves) {
  for (const size_t width : kWidths) {
    Rng rng(1, width);
    std::vector<std::vector<uint8_t>> back, seen;
    for (int r = 0; r < 3; ++r) {
      back.push_back(random_row(width, rng));
      seen.push_back(random_row(width, rng, &back.back()));
    }
    for (const size_t count : {size_t{2}, size_t{3}}) {
      TextureRows rows{.count = count};
      for (size_t r = 0; r < count; ++r) rows.seen[r] = seen[r].data(), rows.background[r] = back[r].data();
      for_each_simd_target([&](const char* name) {
        std::vector<int32_t> sums(texture_sums_size(width));
        std::vector<float> texture(width, -1);
        compare_texture_row(rows, width, sums.data(), texture.data());
        for (size_t x = 0; x < width; ++x) {
          const double expected = texture_at(rows, width, x);
          EXPECT_NEAR(texture[x], expected, 1e-4 + 1e-5 * expected) << name << " width " << width << " x " << x;
        }
      });
    }
  }
}

// Of one pixel, as the header says it.
struct Expected {
  double evidence, plain;
};
Expected evidence_at(const EvidenceRow& row, size_t x) {
  const auto channel = [&](const uint8_t* pixels, size_t c) { return pixels[3 * x + c] - (c == 0 ? 0.0 : 128.0); };
  double here = 0, around = 0;
  const double back = row.gain * channel(row.background, 0);
  const double factor = std::min(channel(row.seen, 0) / std::max(back, 1.0), 1.5);
  double shadow = std::pow((factor - 1) / (factor < 1 ? 0.15 : 0.04), 2);
  for (size_t c = 0; c < 3; ++c) {
    const double weight = row.inverse_noise[c][x];
    here += weight * std::pow(channel(row.seen, c) - row.gain * channel(row.background, c), 2);
    around += weight * std::pow(channel(row.seen_around, c) - row.gain * channel(row.background_around, c), 2);
    if (c > 0) {
      shadow += weight * std::pow(channel(row.seen, c) - factor * row.gain * channel(row.background, c), 2);
    }
  }
  const double plain = std::max(here, std::min(2 * around, 10 * here));
  double least = INFINITY;
  for (const float* texture : row.texture) {
    for (size_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, row.width - 1); ++u) {
      least = std::min(least, static_cast<double>(texture[u]));
    }
  }
  shadow += 3 * std::max(least * static_cast<double>(row.inverse_noise[0][x]) - 1, 0.0);
  return {std::clamp(0.5 * (std::min(plain, shadow) - 22), -4.0, 6.0), plain};
}

TEST(ForegroundEvidence, IsHalfTheDistanceToWhatExplainsThePixelBest) {
  for (const size_t width : kWidths) {
    Rng rng(2, width);
    const std::vector<uint8_t> back = random_row(width, rng), seen = random_row(width, rng, &back),
                               back_around = random_row(width, rng), seen_around = random_row(width, rng, &back_around);
    std::vector<std::vector<float>> noise(3, std::vector<float>(width)), texture = noise;
    for (size_t c = 0; c < 3; ++c) {
      for (size_t x = 0; x < width; ++x) {
        noise[c][x] = static_cast<float>(rng.uniform(0.01, 0.3));
        texture[c][x] = static_cast<float>(rng.uniform(0, 60));
      }
    }
    const EvidenceRow row{.seen = seen.data(),
                          .background = back.data(),
                          .seen_around = seen_around.data(),
                          .background_around = back_around.data(),
                          .inverse_noise = {noise[0].data(), noise[1].data(), noise[2].data()},
                          .texture = {texture[0].data(), texture[1].data(), texture[2].data()},
                          .gain = 1.1f,
                          .width = width};
    for_each_simd_target([&](const char* name) {
      std::vector<float> least(width + 2), evidence(width);
      std::vector<uint8_t> differs(width, 9);
      weigh_evidence_row(row, least.data(), evidence.data(), differs.data());
      for (size_t x = 0; x < width; ++x) {
        const Expected expected = evidence_at(row, x);
        EXPECT_NEAR(evidence[x], expected.evidence, 1e-3) << name << " width " << width << " x " << x;
        if (std::abs(expected.plain - 22) > 1e-3) {
          EXPECT_EQ(differs[x], expected.plain > 22 ? 1 : 0) << name << " x " << x;
        }
      }
    });
  }
}

}  // namespace
}  // namespace silpose
