#include "silpose/segment/background_doubt.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/segment/foreground.h"

namespace silpose {

BackgroundDoubt doubt_background(const BackgroundModel& model, const BackgroundSamples& samples,
                                 const std::optional<Box>& region) {
  constexpr int kStep = 4;      // [guess] every fourth pixel suffices
  constexpr float kSurely = 6;  // [guess] deviations
  const Box box = region.value_or(Box{0, 0, model.width(), model.height()});
  std::vector<float> gains;
  for (const ByteImage& image : samples.images) gains.push_back(exposure_gain(model, image));
  int64_t total = 0, half = 0, ever = 0;
  for (int y = std::max(box.y, 0); y < std::min(box.y + box.height, model.height()); y += kStep) {
    for (int x = std::max(box.x, 0); x < std::min(box.x + box.width, model.width()); x += kStep) {
      size_t covered = 0;
      for (size_t k = 0; k < samples.images.size(); ++k) {
        bool differs = false;
        for (int c = 0; c < 3; ++c) {
          const float centre = c == 0 ? 0.0f : 128.0f;
          const float expected = centre + gains[k] * (static_cast<float>(model.median.at(x, y, c)) - centre);
          differs = differs || std::abs(static_cast<float>(samples.images[k].at(x, y, c)) - expected) >
                                   kSurely * model.noise.at(x, y, c);
        }
        covered += differs ? 1 : 0;
      }
      ++total;
      if (4 * covered >= samples.images.size()) ++half;
      if (covered > 0) ++ever;
    }
  }
  if (total == 0) return {};
  return {static_cast<double>(half) / static_cast<double>(total),
          static_cast<double>(ever) / static_cast<double>(total)};
}

}  // namespace silpose
