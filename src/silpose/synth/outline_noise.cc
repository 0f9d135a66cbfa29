#include "silpose/synth/outline_noise.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/rng.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

constexpr int kWaves = 128;
constexpr double kReach = 0.12;         // largest displacement, of the body's height
constexpr double kNormalRadius = 0.01;  // of the neighbourhood that gives the outline's direction, of the height

struct OutlinePoint {
  int x = 0, y = 0;
  double normal_x = 0, normal_y = 0;  // outwards, unit
};

// Set pixels next to one that is not; where the image ends is no outline.
std::vector<OutlinePoint> find_outline(const Mask& mask, const Box& box, int radius) {
  const auto is_set = [&](int x, int y) {
    return x < 0 || y < 0 || x >= mask.width() || y >= mask.height() || mask.get(x, y);
  };
  std::vector<OutlinePoint> points;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (!mask.get(x, y)) continue;
      if (is_set(x - 1, y) && is_set(x + 1, y) && is_set(x, y - 1) && is_set(x, y + 1)) continue;
      OutlinePoint point{x, y};
      for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
          if (!is_set(x + dx, y + dy)) point.normal_x += dx, point.normal_y += dy;
        }
      }
      if (const double length = std::hypot(point.normal_x, point.normal_y); length > 0) {
        point.normal_x /= length, point.normal_y /= length;
      }
      points.push_back(point);
    }
  }
  return points;
}

// For every pixel of `box`, row by row, the outline point nearest to it. Source: lower envelope of parabolas
// (references.bib: felzenszwalb2012).
std::vector<int> nearest_points(const std::vector<OutlinePoint>& points, const Box& box) {
  const auto width = static_cast<size_t>(box.width), height = static_cast<size_t>(box.height);
  std::vector<int> in_column(width * height, -1);  // nearest point of the same column
  for (size_t i = 0; i < points.size(); ++i) {
    in_column[static_cast<size_t>(points[i].y - box.y) * width + static_cast<size_t>(points[i].x - box.x)] =
        static_cast<int>(i);
  }
  const auto row_of = [&](int point) { return points[static_cast<size_t>(point)].y - box.y; };
  const auto spread = [&](size_t at, size_t from, int y) {
    const int other = in_column[from], own = in_column[at];
    if (other >= 0 && (own < 0 || std::abs(row_of(other) - y) < std::abs(row_of(own) - y))) in_column[at] = other;
  };
  for (size_t y = 1; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) spread(y * width + x, (y - 1) * width + x, static_cast<int>(y));
  }
  for (size_t y = height - 1; y-- > 0;) {
    for (size_t x = 0; x < width; ++x) spread(y * width + x, (y + 1) * width + x, static_cast<int>(y));
  }

  std::vector<int> nearest(width * height, -1);
  std::vector<int> columns;    // of the parabolas on the envelope
  std::vector<double> starts;  // where each begins to be the lowest
  for (size_t y = 0; y < height; ++y) {
    const int* const row = in_column.data() + y * width;
    const auto squared = [&](int x) { return std::pow(row_of(row[x]) - static_cast<int>(y), 2) + double(x) * x; };
    columns.clear(), starts.clear();
    for (int x = 0; x < box.width; ++x) {
      if (row[x] < 0) continue;
      double start = -1;
      while (!columns.empty()) {
        start = (squared(x) - squared(columns.back())) / (2.0 * (x - columns.back()));
        if (start > starts.back()) break;
        columns.pop_back(), starts.pop_back();
      }
      starts.push_back(columns.empty() ? -1 : start);
      columns.push_back(x);
    }
    size_t k = 0;
    for (size_t x = 0; x < width && !columns.empty(); ++x) {
      while (k + 1 < columns.size() && starts[k + 1] < static_cast<double>(x)) ++k;
      nearest[y * width + x] = row[columns[k]];
    }
  }
  return nearest;
}

}  // namespace

OutlineNoise::OutlineNoise(const OutlineNoiseOptions& options, uint64_t seed, uint64_t stream) : bias_(options.bias) {
  check(options.correlation_length > 0 && options.correlation_time_s > 0, "OutlineNoise: correlated over {}, {} s",
        options.correlation_length, options.correlation_time_s);
  check(std::isfinite(options.bias), "OutlineNoise: bias {}", options.bias);
  for (uint64_t k = 0; k < kWaves; ++k) {
    Rng rng(seed, stream, k);
    Wave wave;
    wave.x = rng.normal() / options.correlation_length;
    wave.y = rng.normal() / options.correlation_length;
    wave.normal_x = rng.normal();
    wave.normal_y = rng.normal();
    wave.time = rng.normal() / options.correlation_time_s;
    wave.phase = rng.uniform(0, 2 * kPi);
    waves_.push_back(wave);
  }
}

std::vector<OutlineNoise::Change> OutlineNoise::changes(const Mask& truth, double height_px, double time_s) const {
  check(height_px > 0, "OutlineNoise: body of {} px", height_px);
  const Box body = truth.bounding_box();
  if (body.empty()) return {};
  const std::vector<OutlinePoint> points =
      find_outline(truth, body, std::max(2, static_cast<int>(std::lround(kNormalRadius * height_px))));
  if (points.empty()) return {};  // the body fills the image

  double middle_x = 0, middle_y = 0;
  for (const OutlinePoint& point : points) middle_x += point.x, middle_y += point.y;
  middle_x /= static_cast<double>(points.size()), middle_y /= static_cast<double>(points.size());
  std::vector<double> displacement;  // by point, in standard deviations
  for (const OutlinePoint& point : points) {
    const double x = (point.x - middle_x) / height_px, y = (point.y - middle_y) / height_px;
    double sum = 0;
    for (const Wave& wave : waves_) {
      sum += std::cos(wave.x * x + wave.y * y + wave.normal_x * point.normal_x + wave.normal_y * point.normal_y +
                      wave.time * time_s + wave.phase);
    }
    displacement.push_back(std::sqrt(2.0 / kWaves) * sum + bias_);
  }

  const double reach = kReach * height_px;
  const int margin = static_cast<int>(std::ceil(reach)) + 1;
  Box box;
  box.x = std::max(0, body.x - margin), box.y = std::max(0, body.y - margin);
  box.width = std::min(truth.width(), body.x + body.width + margin) - box.x;
  box.height = std::min(truth.height(), body.y + body.height + margin) - box.y;
  const std::vector<int> nearest = nearest_points(points, box);
  std::vector<Change> changes;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const auto point = static_cast<size_t>(
          nearest[static_cast<size_t>(y - box.y) * static_cast<size_t>(box.width) + static_cast<size_t>(x - box.x)]);
      const bool is_inside = truth.get(x, y);
      const double outwards = displacement[point];
      if (is_inside == (outwards > 0) || outwards == 0) continue;
      // The outline runs half a pixel outside of its pixels' centres.
      const double depth = std::hypot(x - points[point].x, y - points[point].y) + (is_inside ? 0.5 : -0.5);
      const double amplitude = depth / (std::abs(outwards) * height_px);
      if (depth <= reach && amplitude <= kLargestAmplitude) changes.push_back({x, y, amplitude});
    }
  }
  return changes;
}

}  // namespace silpose
