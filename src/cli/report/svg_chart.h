// Line charts as inline SVG: no script, nothing to load, readable in print.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace aligngs {

struct ChartSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< (x, y), x ascending; non-finite points are left out
};

struct ChartOptions {
  std::string title, x_label, y_label;
  bool log_y = false;             ///< logarithmic y axis; values <= 0 are left out
  int width = 560, height = 260;  ///< pixels
};

/// A complete <svg> element. Without any finite point it says "no data".
std::string svg_line_chart(const ChartOptions& options, const std::vector<ChartSeries>& series);

/// Ticks at 1, 2 or 5 times a power of ten that cover [low, high].
std::vector<double> round_ticks(double low, double high, int wanted);

/// log10 of ticks at 1, 2 and 5, or fewer of these, times powers of ten in [10^low, 10^high]. Even ticks where the range
/// is too small for one of these.
std::vector<double> log_ticks(double low, double high, int wanted);

/// &, <, > and quotes escaped for HTML and SVG.
std::string escape_html(const std::string& text);

}  // namespace aligngs
