// SvgPlot: bars by category or lines over numbers, as one SVG image with axes, ticks, labels and a legend.
// Threads: values and a function without state.
#pragma once

#include <string>
#include <vector>

namespace silpose {

struct SvgSeries {
  std::string name;
  std::vector<double> x;  // of lines; bars stand in the order of the categories
  std::vector<double> y;  // NaN: nothing there
};

struct SvgPlot {
  std::string title, x_label, y_label;
  std::vector<std::string> categories;  // of bars; empty: lines
  std::vector<SvgSeries> series;
};

// Errors: throws std::invalid_argument where a series' sizes do not fit.
std::string svg_from_plot(const SvgPlot& plot);

// Ticks that cover [0 or low, high] in round steps, at most about `most`; the last is not below `high`.
std::vector<double> round_ticks(double low, double high, int most = 6);

}  // namespace silpose
