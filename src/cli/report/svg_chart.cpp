#include "cli/report/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr int kLeft = 58, kRight = 14, kTop = 48, kBottom = 40;  // pixels around the plot area
constexpr int kTitleLine = 18, kLegendLine = 36;                 // baselines above it, pixels
constexpr int kTicks = 5;                                        // about so many of the y axis
const char* const kPalette[] = {"#2563eb", "#dc2626", "#059669", "#d97706", "#7c3aed", "#0891b2", "#be185d", "#4b5563"};

struct Range {
  double low = INFINITY, high = -INFINITY;
  void include(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return !(low <= high); }
  void widen() {
    if (low == high) low -= 0.5, high += 0.5;
  }
};

bool usable(const std::pair<double, double>& p, bool log_y) {
  return std::isfinite(p.first) && std::isfinite(p.second) && (!log_y || p.second > 0);
}

std::string tick_text(double value) {
  const double magnitude = std::fabs(value);
  if (magnitude >= 1e6 || (magnitude > 0 && magnitude < 1e-3)) return fmt::format("{:.0e}", value);
  if (magnitude >= 10000) return fmt::format("{:g}k", value / 1000);
  return magnitude < 100 ? fmt::format("{:.3g}", value) : fmt::format("{:g}", value);
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::vector<double> round_ticks(double low, double high, int wanted) {
  std::vector<double> ticks;
  if (!(high > low) || wanted < 1) return ticks;
  const double raw = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double share = raw / power;
  const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
  for (double t = std::ceil(low / step - 1e-9) * step; t <= high + 1e-9 * step; t += step) {
    ticks.push_back(std::fabs(t) < 1e-9 * step ? 0 : t);
  }
  return ticks;
}

std::vector<double> log_ticks(double low, double high, int wanted) {
  // As many of 1, 2 and 5 in each power of ten as leave at most about twice the wanted number.
  for (const std::vector<double>& digits : {std::vector<double>{1, 2, 5}, std::vector<double>{1, 3}, {1.0}}) {
    std::vector<double> ticks;
    for (double power = std::floor(low); power <= high; ++power) {
      for (const double digit : digits) {
        const double t = power + std::log10(digit);
        if (t >= low - 1e-9 && t <= high + 1e-9) ticks.push_back(t);
      }
    }
    if (ticks.size() < 2) break;
    if (ticks.size() <= 2 * static_cast<size_t>(wanted)) return ticks;
  }
  return round_ticks(low, high, wanted);
}

std::string svg_line_chart(const ChartOptions& options, const std::vector<ChartSeries>& series) {
  const auto transform = [&](double y) { return options.log_y ? std::log10(y) : y; };
  Range xs, ys;
  for (const ChartSeries& s : series) {
    for (const auto& p : s.points) {
      if (!usable(p, options.log_y)) continue;
      xs.include(p.first);
      ys.include(transform(p.second));
    }
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">"
      "<text x=\"{2}\" y=\"{3}\" class=\"chart-title\">{4}</text>",
      options.width, options.height, kLeft, kTitleLine, escape_html(options.title));
  if (xs.empty()) {
    return svg +
           fmt::format("<text x=\"{}\" y=\"{}\">no data</text></svg>", options.width / 2 - 25, options.height / 2);
  }
  xs.widen();
  ys.widen();
  const double plot_width = options.width - kLeft - kRight, plot_height = options.height - kTop - kBottom;
  const auto px = [&](double x) { return kLeft + (x - xs.low) / (xs.high - xs.low) * plot_width; };
  const auto py = [&](double y) { return kTop + (ys.high - y) / (ys.high - ys.low) * plot_height; };
  const std::vector<double> y_ticks =
      options.log_y ? log_ticks(ys.low, ys.high, kTicks) : round_ticks(ys.low, ys.high, kTicks);
  for (const double t : y_ticks) {
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/><text x=\"{}\" y=\"{:.1f}\" "
        "class=\"tick\" text-anchor=\"end\">{}</text>",
        kLeft, options.width - kRight, py(t), py(t), kLeft - 6, py(t) + 4,
        tick_text(options.log_y ? std::pow(10.0, t) : t));
  }
  for (const double t : round_ticks(xs.low, xs.high, 6)) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" class=\"tick\" text-anchor=\"middle\">{}</text>", px(t),
                       options.height - kBottom + 16, tick_text(t));
  }
  svg += fmt::format("<text x=\"{}\" y=\"{}\" class=\"tick\" text-anchor=\"end\">{}</text>", options.width - kRight,
                     options.height - 8, escape_html(options.x_label));
  int index = 0;
  double legend_x = kLeft;
  for (const ChartSeries& s : series) {
    const char* color = kPalette[index++ % std::size(kPalette)];
    std::string path;
    for (const auto& p : s.points) {
      if (usable(p, options.log_y))
        path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", px(p.first), py(transform(p.second)));
    }
    if (path.empty()) continue;
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>", path, color);
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{}\" fill=\"{}\" class=\"legend\">{}</text>", legend_x, kLegendLine,
                       color, escape_html(s.name));
    legend_x += 14 + 6.2 * static_cast<double>(s.name.size());  // about 6.2 px per letter at 11 px type
  }
  return svg + "</svg>";
}

}  // namespace aligngs
