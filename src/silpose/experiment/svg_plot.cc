#include "silpose/experiment/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kHeight = 420, kLeft = 70, kRight = 24, kTop = 64, kBottom = 66;
// Colours that people with any colour vision can distinguish.
constexpr std::array<const char*, 6> kColours = {"#0072b2", "#e69f00", "#009e73", "#d55e00", "#56b4e9", "#cc79a7"};

const char* colour_of(size_t series) { return kColours[series % kColours.size()]; }

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) safe += c;
    }
  }
  return safe;
}

// A map from values to pixels along one axis.
struct Scale {
  double low, high, pixel_low, pixel_high;
  [[nodiscard]] double operator()(double value) const {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
};

std::string text_at(double x, double y, const std::string& text, const std::string& more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, escaped(text));
}

std::string line_at(double x1, double y1, double x2, double y2, const char* stroke) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2, y2,
                     stroke);
}

std::string legend(const SvgPlot& plot) {
  std::string svg;
  double x = kLeft;
  for (size_t s = 0; s < plot.series.size(); ++s) {
    if (plot.series[s].name.empty()) continue;
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"36\" width=\"12\" height=\"12\" fill=\"{}\"/>\n", x, colour_of(s));
    svg += text_at(x + 17, 46, plot.series[s].name, "");
    x += 40 + 7.2 * static_cast<double>(plot.series[s].name.size());
  }
  return svg;
}

std::string bars(const SvgPlot& plot, const Scale& x_of, const Scale& y_of) {
  std::string svg;
  const double slot = x_of(1) - x_of(0);
  const double bar = 0.8 * slot / static_cast<double>(std::max<size_t>(plot.series.size(), 1));
  for (size_t s = 0; s < plot.series.size(); ++s) {
    for (size_t i = 0; i < plot.categories.size(); ++i) {
      const double y = plot.series[s].y[i];
      if (!std::isfinite(y)) continue;
      const double left = x_of(static_cast<double>(i)) + 0.1 * slot + bar * static_cast<double>(s);
      const double top = std::min(y_of(y), y_of(0)), height = std::abs(y_of(y) - y_of(0));
      svg += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"><title>{}</title></rect>\n",
          left, top, bar, height, colour_of(s),
          escaped(fmt::format("{} {}: {:.4g}", plot.categories[i], plot.series[s].name, y)));
    }
  }
  size_t longest = 0;
  for (const std::string& category : plot.categories) longest = std::max(longest, category.size());
  const bool turned = 7.2 * static_cast<double>(longest) > slot;
  for (size_t i = 0; i < plot.categories.size(); ++i) {
    const double x = x_of(static_cast<double>(i) + 0.5), y = kHeight - kBottom + 16;
    const std::string how = turned ? fmt::format(" text-anchor=\"end\" transform=\"rotate(-35 {:.1f} {:.1f})\"", x, y)
                                   : std::string(" text-anchor=\"middle\"");
    svg += text_at(x, y, plot.categories[i], how);
  }
  return svg;
}

std::string lines(const SvgPlot& plot, const Scale& x_of, const Scale& y_of) {
  std::string svg;
  for (size_t s = 0; s < plot.series.size(); ++s) {
    const SvgSeries& series = plot.series[s];
    std::string path;
    bool pen_down = false;
    for (size_t i = 0; i < series.y.size(); ++i) {
      if (!std::isfinite(series.y[i]) || !std::isfinite(series.x[i])) {
        pen_down = false;
        continue;
      }
      path += fmt::format("{}{:.1f} {:.1f}",
                          pen_down       ? " L"
                          : path.empty() ? "M"
                                         : " M",
                          x_of(series.x[i]), y_of(series.y[i]));
      pen_down = true;
    }
    if (path.empty()) continue;
    svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", path, colour_of(s));
  }
  return svg;
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int most) {
  low = std::min(low, 0.0);
  if (!(high > low)) high = low + 1;
  const double rough = (high - low) / most, power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * (1 - 1e-9)) step = factor * power;
  }
  std::vector<double> ticks;
  const double first = std::floor(low / step + 1e-9);
  for (int i = 0;; ++i) {
    ticks.push_back((first + i) * step);
    if (ticks.back() >= high - 1e-9 * step) return ticks;
  }
}

std::string svg_from_plot(const SvgPlot& plot) {
  const bool is_bars = !plot.categories.empty();
  double low = 0, high = 0, x_low = std::numeric_limits<double>::infinity(), x_high = -x_low;
  for (const SvgSeries& series : plot.series) {
    check(series.y.size() == (is_bars ? plot.categories.size() : series.x.size()), "plot '{}': {} values in '{}'",
          plot.title, series.y.size(), series.name);
    for (const double y : series.y) {
      if (std::isfinite(y)) low = std::min(low, y), high = std::max(high, y);
    }
    for (const double x : series.x) {
      if (std::isfinite(x)) x_low = std::min(x_low, x), x_high = std::max(x_high, x);
    }
  }
  if (is_bars) x_low = 0, x_high = static_cast<double>(plot.categories.size());
  if (!(x_high > x_low)) x_low = std::isfinite(x_low) ? x_low : 0, x_high = x_low + 1;

  const auto num_bars = static_cast<double>(plot.categories.size() * std::max<size_t>(plot.series.size(), 1));
  const double width = std::max(720.0, kLeft + kRight + (is_bars ? 9 * num_bars : 0));
  const std::vector<double> ticks = round_ticks(low, high);
  const Scale x_of{x_low, x_high, kLeft, width - kRight};
  const Scale y_of{ticks.front(), ticks.back(), kHeight - kBottom, kTop};

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
      width, kHeight);
  svg += text_at(kLeft, 22, plot.title, " font-size=\"15\" font-weight=\"bold\"");
  svg += legend(plot);
  for (const double tick : ticks) {
    svg += line_at(kLeft, y_of(tick), width - kRight, y_of(tick), "#dddddd");
    svg += text_at(kLeft - 8, y_of(tick) + 4, fmt::format("{:.6g}", tick), " text-anchor=\"end\"");
  }
  if (!is_bars) {
    for (const double tick : round_ticks(x_low, x_high, 8)) {
      if (tick < x_low || tick > x_high) continue;
      svg += line_at(x_of(tick), kHeight - kBottom, x_of(tick), kHeight - kBottom + 5, "#333333");
      svg += text_at(x_of(tick), kHeight - kBottom + 19, fmt::format("{:.6g}", tick), " text-anchor=\"middle\"");
    }
  }
  svg += is_bars ? bars(plot, x_of, y_of) : lines(plot, x_of, y_of);
  svg += line_at(kLeft, y_of(0), width - kRight, y_of(0), "#333333");
  svg += line_at(kLeft, kTop, kLeft, kHeight - kBottom, "#333333");
  svg += text_at((kLeft + width - kRight) / 2, kHeight - 10, plot.x_label, " text-anchor=\"middle\"");
  const double middle = (kTop + kHeight - kBottom) / 2;
  svg += text_at(16, middle, plot.y_label,
                 fmt::format(" text-anchor=\"middle\" transform=\"rotate(-90 16 {:.1f})\"", middle));
  return svg + "</svg>\n";
}

}  // namespace silpose
