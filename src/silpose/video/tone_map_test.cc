#include "silpose/video/tone_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "silpose/base/rng.h"
#include "silpose/video/clip_for_test.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

using Colour = std::array<double, 3>;
using testing::ElementsAre;
using testing::EndsWith;

// The way there, written down by itself: sRGB to light of a diffuse white of 203 cd/m2, wide primaries, then coded.
Colour coded(HdrTransfer transfer, const Colour& srgb) {
  Colour light{}, wide{};
  for (size_t c = 0; c < 3; ++c) {
    light[c] = srgb[c] <= 0.04045 ? srgb[c] / 12.92 : std::pow((srgb[c] + 0.055) / 1.055, 2.4);
  }
  const double to_wide[3][3] = {{0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}};
  for (size_t c = 0; c < 3; ++c) {
    for (size_t k = 0; k < 3; ++k) wide[c] += 203 * to_wide[c][k] * light[k];
  }
  Colour result{};
  if (transfer == HdrTransfer::kPq) {
    for (size_t c = 0; c < 3; ++c) {
      const double p = std::pow(wide[c] / 10000, 0.1593017578125);
      result[c] = std::pow((0.8359375 + 18.8515625 * p) / (1 + 18.6875 * p), 78.84375);
    }
    return result;
  }
  const double luminance = 0.2627 * wide[0] + 0.6780 * wide[1] + 0.0593 * wide[2];
  for (size_t c = 0; c < 3; ++c) {
    // Of the scene: the system gamma of 1.2 taken back.
    const double scene = wide[c] / 1000 * std::pow(std::max(luminance, 1e-9) / 1000, (1 - 1.2) / 1.2);
    result[c] = scene <= 1.0 / 12 ? std::sqrt(3 * scene) : 0.17883277 * std::log(12 * scene - 0.28466892) + 0.55991073;
  }
  return result;
}

constexpr HdrTransfer kBoth[] = {HdrTransfer::kHlg, HdrTransfer::kPq};

TEST(ToneMap, ColoursBelowTheKneeAreAsTheyWere) {
  for (const HdrTransfer transfer : kBoth) {
    for (const Colour& srgb : {Colour{0, 0, 0},
                               {0.5, 0.5, 0.5},
                               {0.65, 0.1, 0.1},
                               {0.1, 0.6, 0.2},
                               {0.05, 0.1, 0.6},
                               {0.6, 0.45, 0.35},
                               {0.02, 0.01, 0.03}}) {
      const Colour shown = sdr_colour(transfer, coded(transfer, srgb));
      for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(255 * shown[c], 255 * srgb[c], 1.0) << srgb[0] << " " << srgb[1];
    }
  }
}

TEST(ToneMap, WhitesRollOff) {
  // BT.2408: the diffuse white is 75 % of HLG, 58 % of PQ.
  const Colour white = sdr_colour(HdrTransfer::kHlg, {0.75, 0.75, 0.75});
  EXPECT_NEAR(255 * white[0], 255 * sdr_colour(HdrTransfer::kPq, {0.58, 0.58, 0.58})[0], 1.5);
  EXPECT_GT(255 * white[0], 220);
  EXPECT_LT(255 * white[0], 240);
  for (const HdrTransfer transfer : kBoth) {
    double before = 0;
    for (double level = 0; level <= 1; level += 1.0 / 64) {
      const Colour grey = sdr_colour(transfer, {level, level, level});
      EXPECT_NEAR(grey[0], grey[1], 1e-3);
      EXPECT_NEAR(grey[0], grey[2], 1e-3);
      EXPECT_GE(grey[0], before - 1e-6);
      before = grey[0];
    }
    EXPECT_NEAR(before, 1, 1e-3);
  }
}

TEST(ToneMap, TablesAreWithinAGreyLevel) {
  Rng rng(5);
  for (const HdrTransfer transfer : kBoth) {
    constexpr int kColours = 4000;
    std::array<std::vector<uint16_t>, 3> planes;
    std::vector<Colour> expected;
    for (int x = 0; x < kColours; ++x) {
      const Colour given{rng.uniform(), rng.uniform(), rng.uniform()};
      Colour stored{};
      for (size_t c = 0; c < 3; ++c) {
        planes[c].push_back(static_cast<uint16_t>(std::lround(1023 * given[c])));
        stored[c] = planes[c].back() / 1023.0;
      }
      expected.push_back(sdr_colour(transfer, stored));
    }
    std::vector<uint8_t> shown(3 * kColours);
    ToneMap(transfer).apply(planes[0], planes[1], planes[2], shown);
    double sum = 0, most = 0;
    for (size_t x = 0; x < expected.size(); ++x) {
      for (size_t c = 0; c < 3; ++c) {
        const double off = std::abs(shown[3 * x + 2 - c] - 255 * expected[x][c]);
        sum += off / (3 * kColours);
        most = std::max(most, off);
      }
    }
    EXPECT_LT(sum, 0.5);
    EXPECT_LT(most, 1.5);
  }
}

TEST(ToneMap, ClipsComeBackInTheColoursThatWereFilmed) {
  const auto path = std::filesystem::temp_directory_path() / "silpose_tone_map.mp4";
  const Colour patches[] = {{0.5, 0.5, 0.5}, {0.6, 0.15, 0.1}, {0.15, 0.6, 0.2}, {0.1, 0.15, 0.6}};
  for (const HdrTransfer transfer : kBoth) {
    ByteImage stored(128, 64, 3);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 128; ++x) {
        const Colour colour = coded(transfer, patches[x / 32]);
        for (int c = 0; c < 3; ++c) {
          stored.at(x, y, 2 - c) = static_cast<uint8_t>(std::lround(255 * colour[static_cast<size_t>(c)]));
        }
      }
    }
    const bool is_hlg = transfer == HdrTransfer::kHlg;
    write_clip_for_test(path, std::vector<ByteImage>(2, stored),
                        {.pixel_format = "yuv420p10le",
                         .colour_space = AVCOL_SPC_BT2020_NCL,
                         .transfer = is_hlg ? AVCOL_TRC_ARIB_STD_B67 : AVCOL_TRC_SMPTE2084});
    Video video = open_video(path.string()).value();
    const ByteImage shown = video.next().value()->images[0];
    for (int patch = 0; patch < 4; ++patch) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(shown.at(16 + 32 * patch, 32, 2 - c), 255 * patches[patch][static_cast<size_t>(c)], 5)
            << (is_hlg ? "HLG, patch " : "PQ, patch ") << patch << ", channel " << c;
      }
    }
    EXPECT_THAT(video.warnings(), ElementsAre(EndsWith(is_hlg ? "HDR (HLG), converted to standard range"
                                                              : "HDR (PQ), converted to standard range")));
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace silpose
