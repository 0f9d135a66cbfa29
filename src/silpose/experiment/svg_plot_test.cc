#include "silpose/experiment/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

namespace silpose {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

// Every element is closed in order, attributes are quoted, and no bare & or < is left in text.
bool is_well_formed(const std::string& svg) {
  static const std::regex kTag(R"(<(/?)([a-z]+)((?:\s+[A-Za-z0-9-]+="[^"<&]*")*)\s*(/?)>)");
  static const std::regex kText(R"([^<>&]*(?:&(?:amp|lt|gt|quot);[^<>&]*)*)");
  std::vector<std::string> open;
  auto at = svg.cbegin();
  for (std::sregex_iterator it(svg.begin(), svg.end(), kTag), end; it != end; ++it) {
    if (!std::regex_match(at, (*it)[0].first, kText)) return false;
    at = (*it)[0].second;
    const std::string name = (*it)[2];
    if ((*it)[1].length() > 0) {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    } else if ((*it)[4].length() == 0) {
      open.push_back(name);
    }
  }
  return open.empty() && std::regex_match(at, svg.cend(), kText);
}

size_t count(const std::string& text, const std::string& word) {
  size_t found = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(SvgPlot, TheCheckerOfTheseTestsSeesMistakes) {
  EXPECT_TRUE(is_well_formed("<svg a=\"1\"><g/>x &amp; y</svg>"));
  EXPECT_FALSE(is_well_formed("<svg><g></svg></g>"));
  EXPECT_FALSE(is_well_formed("<svg>a & b</svg>"));
  EXPECT_FALSE(is_well_formed("<svg>"));
}

TEST(SvgPlot, BarsWithLabelsLegendAndGaps) {
  const SvgPlot plot{.title = "Errors & <odd> \"names\"",
                     .x_label = "clip",
                     .y_label = "mm",
                     .categories = {"walk", "a long name that is turned", "R&B"},
                     .series = {{"default", {}, {30, kNothing, 12}}, {"accurate", {}, {10, 20, -3}}}};
  const std::string svg = svg_from_plot(plot);
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "<title>"), 5u);  // one a bar
  EXPECT_THAT(svg, HasSubstr(">accurate</text>"));
  EXPECT_THAT(svg, HasSubstr("R&amp;B"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(SvgPlot, LinesBreakWhereNothingIs) {
  const SvgPlot plot{.title = "Error",
                     .x_label = "frame",
                     .y_label = "px",
                     .categories = {},
                     .series = {{"side", {0, 1, 2, 3, 4}, {1, 2, kNothing, 4, 5}}}};
  const std::string svg = svg_from_plot(plot);
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "M70.0"), 1u);
  EXPECT_EQ(count(svg, " M"), 1u);  // resumed once
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(SvgPlot, NothingToDrawIsStillAnImage) {
  EXPECT_TRUE(is_well_formed(svg_from_plot({})));
  EXPECT_TRUE(is_well_formed(svg_from_plot({.title = "", .categories = {"a"}, .series = {{"s", {}, {kNothing}}}})));
  EXPECT_THROW((void)svg_from_plot({.categories = {"a"}, .series = {{"s", {}, {1, 2}}}}), std::invalid_argument);
}

TEST(RoundTicks, CoverTheRange) {
  EXPECT_THAT(round_ticks(0, 30), ElementsAre(DoubleEq(0), DoubleEq(5), DoubleEq(10), DoubleEq(15), DoubleEq(20),
                                              DoubleEq(25), DoubleEq(30)));
  EXPECT_THAT(round_ticks(0, 0.47),
              ElementsAre(DoubleEq(0), DoubleNear(0.1, 1e-12), DoubleNear(0.2, 1e-12), DoubleNear(0.3, 1e-12),
                          DoubleNear(0.4, 1e-12), DoubleNear(0.5, 1e-12)));
  EXPECT_THAT(round_ticks(-7, 5, 3), ElementsAre(DoubleEq(-10), DoubleEq(-5), DoubleEq(0), DoubleEq(5)));
  EXPECT_THAT(round_ticks(0, 0), ElementsAre(DoubleEq(0), DoubleEq(0.2), DoubleEq(0.4), DoubleNear(0.6, 1e-12),
                                             DoubleEq(0.8), DoubleEq(1)));
}

}  // namespace
}  // namespace silpose
