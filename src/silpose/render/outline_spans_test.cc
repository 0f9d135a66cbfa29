#include "silpose/render/outline_spans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"

namespace silpose {
namespace {

using Pixels = std::vector<Eigen::Vector2f>;

// A ring of quads around a torus, its vertices scattered; open where `is_open`.
std::vector<Face> torus_faces(uint32_t rings, uint32_t sectors, bool is_open) {
  std::vector<Face> faces;
  const auto index = [&](uint32_t r, uint32_t s) { return (r % rings) * sectors + s % sectors; };
  for (uint32_t r = 0; r + (is_open ? 1 : 0) < rings; ++r) {
    for (uint32_t s = 0; s < sectors; ++s) {
      faces.push_back({index(r, s), index(r + 1, s), index(r + 1, s + 1)});
      faces.push_back({index(r, s), index(r + 1, s + 1), index(r, s + 1)});
    }
  }
  return faces;
}

Pixels torus_pixels(uint32_t rings, uint32_t sectors, double noise, Rng& rng) {
  Pixels pixels;
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < sectors; ++s) {
      const double a = 2 * kPi * r / rings, b = 2 * kPi * s / sectors, ring = 30 + 12 * std::cos(b);
      pixels.emplace_back(static_cast<float>(20 + ring * std::cos(a) + noise * rng.normal()),
                          static_cast<float>(30 + 0.8 * ring * std::sin(a) + 6 * std::sin(b) + noise * rng.normal()));
    }
  }
  return pixels;
}

// Intervals of one row, as x of their ends.
using Row = std::vector<double>;

// Plainly: every triangle is cut with every row, the intervals are united.
std::map<int, Row> united_rows(const Pixels& pixels, const std::vector<Face>& faces, const SampledRows& rows) {
  std::map<int, Row> united;
  for (int r = 0; r < rows.count; ++r) {
    const float y = rows.first + static_cast<float>(r) * rows.step;
    std::vector<std::pair<double, double>> intervals;
    for (const Face& face : faces) {
      Row crossings;
      for (size_t side = 0; side < 3; ++side) {
        Eigen::Vector2d a = pixels[face[side]].cast<double>(), b = pixels[face[(side + 1) % 3]].cast<double>();
        if (b.y() < a.y()) std::swap(a, b);
        if (a.y() <= y && y < b.y()) crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      if (std::ranges::any_of(face, [&](uint32_t v) { return std::isnan(pixels[v].x()); })) continue;
      if (crossings.size() == 2) intervals.push_back(std::minmax(crossings[0], crossings[1]));
    }
    std::ranges::sort(intervals);
    for (const auto& [left, right] : intervals) {
      Row& row = united[r];
      if (row.empty() || left > row.back()) {
        row.insert(row.end(), {left, right});
      } else {
        row.back() = std::max(row.back(), right);
      }
    }
  }
  return united;
}

// The same from OutlineSpans; also that beginnings and ends alternate, and lie on the edges that they name.
std::map<int, Row> scanned_rows(OutlineSpans& spans, const Pixels& pixels, const SampledRows& rows, bool some_unseen) {
  spans.scan(pixels, rows, some_unseen);
  const SpanEnds ends = spans.ends();
  std::vector<size_t> order(ends.count);
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](size_t i) { return std::pair(ends.row[i], ends.x[i]); });
  std::map<int, Row> scanned;
  for (size_t k = 0; k < order.size(); ++k) {
    Row& row = scanned[ends.row[order[k]]];
    // At one x either may come first.
    const float expected = row.size() % 2 == 0 ? 1 : -1;
    for (size_t n = k + 1; n < order.size() && ends.x[order[n]] == ends.x[order[k]]; ++n) {
      if (ends.side[order[k]] != expected) std::swap(order[k], order[n]);
    }
    const size_t i = order[k];
    EXPECT_EQ(ends.side[i], expected) << "row " << ends.row[i];
    row.push_back(ends.x[i]);
    const OutlineSpans::OnEdge at = spans.edge_of(i);
    const Eigen::Vector2f x = (1 - at.t) * pixels[at.vertex_a] + at.t * pixels[at.vertex_b];
    EXPECT_NEAR(x.x(), ends.x[i], 1e-2);
    EXPECT_NEAR(x.y(), rows.first + static_cast<float>(ends.row[i]) * rows.step, 1e-3);
  }
  return scanned;
}

// How many pixels of the rows two sets of intervals differ by.
double difference(const std::map<int, Row>& some, const std::map<int, Row>& others) {
  std::map<int, std::vector<std::pair<double, int>>> changes;
  for (const auto* const set : {&some, &others}) {
    for (const auto& [r, row] : *set) {
      for (size_t i = 0; i < row.size(); ++i) {
        changes[r].emplace_back(row[i], ((i % 2 == 0) == (set == &some)) ? 1 : -1);
      }
    }
  }
  double sum = 0;
  for (auto& [r, row] : changes) {
    std::ranges::sort(row);
    int more = 0;
    for (size_t i = 0; i + 1 < row.size(); ++i) {
      more += row[i].second;
      sum += std::abs(more) * (row[i + 1].first - row[i].first);
    }
  }
  return sum;
}

TEST(OutlineSpans, AreTheUnionOfTheTriangles) {
  Rng rng(3);
  for (const bool is_open : {false, true}) {
    const std::vector<Face> faces = torus_faces(17, 11, is_open);
    const EdgeTopology topology(faces);
    OutlineSpans spans(topology);
    for (const double noise : {0.0, 0.5, 8.0}) {
      const Pixels pixels = torus_pixels(17, 11, noise, rng);
      for (const SampledRows& rows : {SampledRows{0.7f, 1.3f, 45}, SampledRows{1, 0.1f, 500}}) {
        const auto united = united_rows(pixels, faces, rows);
        for_each_simd_target([&](const char* target) {
          SCOPED_TRACE(target);
          EXPECT_LT(difference(scanned_rows(spans, pixels, rows, false), united), 1e-2);
          EXPECT_LT(difference(scanned_rows(spans, pixels, rows, true), united), 1e-2);
        });
      }
    }
  }
}

TEST(OutlineSpans, LeaveOutFacesWithAnUnseenVertex) {
  Rng rng(4);
  const std::vector<Face> faces = torus_faces(17, 11, false);
  const EdgeTopology topology(faces);
  OutlineSpans spans(topology);
  Pixels pixels = torus_pixels(17, 11, 0.5, rng);
  for (size_t v = 0; v < pixels.size(); v += 7) pixels[v].x() = std::numeric_limits<float>::quiet_NaN();
  const SampledRows rows{0.7f, 1.3f, 45};
  const auto united = united_rows(pixels, faces, rows);
  EXPECT_FALSE(united.empty());
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    EXPECT_LT(difference(scanned_rows(spans, pixels, rows, true), united), 1e-2);
  });
  std::ranges::fill(pixels, Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_TRUE(scanned_rows(spans, pixels, rows, true).empty());
}

TEST(OutlineSpans, AreNoneWhereNoRowIsCrossed) {
  Rng rng(5);
  const EdgeTopology topology(torus_faces(17, 11, false));
  const Pixels pixels = torus_pixels(17, 11, 0, rng);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    OutlineSpans spans(topology);  // fresh: no earlier scan has made room for crossings
    EXPECT_TRUE(scanned_rows(spans, pixels, {500, 1, 20}, false).empty());
    EXPECT_TRUE(scanned_rows(spans, pixels, {500, 1, 20}, true).empty());
  });
}

}  // namespace
}  // namespace silpose
