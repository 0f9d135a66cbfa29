#include "silpose/segment/plate.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/segment/clean_up.h"

namespace silpose {
namespace {

constexpr double kMargin = 0.04;     // [guess] of the larger side of the mask's box
constexpr size_t kLeastTimes = 5;    // [guess]
constexpr double kLeastShare = 0.1;  // [guess] of the images

}  // namespace

Plate learn_plate(const std::vector<ByteImage>& images, const std::vector<Mask>& subjects) {
  check(!images.empty() && images.size() == subjects.size(), "learn_plate: {} images, {} masks", images.size(),
        subjects.size());
  const int width = images[0].width(), height = images[0].height();
  Plate plate{ByteImage(width, height, 3), Mask(width, height)};
  std::vector<const ByteImage*> used;
  std::vector<Mask> taken;
  for (size_t k = 0; k < images.size(); ++k) {
    const Box box = subjects[k].bounding_box();
    if (box.empty()) continue;
    used.push_back(&images[k]);
    taken.push_back(grow(subjects[k], static_cast<int>(std::lround(kMargin * std::max(box.width, box.height)))));
  }
  const size_t enough = std::max(kLeastTimes, static_cast<size_t>(kLeastShare * static_cast<double>(used.size())));
  parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end) {
    std::vector<size_t> free;
    std::vector<uint8_t> values;
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        free.clear();
        for (size_t k = 0; k < used.size(); ++k) {
          if (!taken[k].get(x, y)) free.push_back(k);
        }
        if (free.size() < enough) continue;
        plate.known.set(x, y);
        for (int c = 0; c < 3; ++c) {
          values.clear();
          for (const size_t k : free) values.push_back(used[k]->at(x, y, c));
          const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
          std::nth_element(values.begin(), middle, values.end());
          plate.colours.at(x, y, c) = *middle;
        }
      }
    }
  });
  return plate;
}

}  // namespace silpose
