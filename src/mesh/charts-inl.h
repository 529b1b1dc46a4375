// The cells that a triangle covers; included by charts.h.
#pragma once

#include <algorithm>
#include <cmath>

namespace aligngs {

template <class Body>
void for_cells(const std::array<std::array<double, 2>, 3>& c, double margin, Body&& body) {
  const double area = (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
  if (area == 0) return;
  std::array<double, 3> reach;  // weight of a corner per cell of distance from the edge across
  for (size_t i = 0; i < 3; ++i) {
    const auto& a = c[(i + 1) % 3];
    const auto& b = c[(i + 2) % 3];
    reach[i] = margin * std::hypot(b[0] - a[0], b[1] - a[1]) / std::abs(area);
  }
  const auto [x0, x1] = std::minmax({c[0][0], c[1][0], c[2][0]});
  const auto [y0, y1] = std::minmax({c[0][1], c[1][1], c[2][1]});
  for (int y = static_cast<int>(std::floor(y0 - margin)); y <= static_cast<int>(std::floor(y1 + margin)); ++y) {
    for (int x = static_cast<int>(std::floor(x0 - margin)); x <= static_cast<int>(std::floor(x1 + margin)); ++x) {
      const double px = x + 0.5, py = y + 0.5;
      std::array<double, 3> w;
      bool in = true;
      for (size_t i = 0; i < 3; ++i) {
        const auto& a = c[(i + 1) % 3];
        const auto& b = c[(i + 2) % 3];
        w[i] = ((b[0] - a[0]) * (py - a[1]) - (px - a[0]) * (b[1] - a[1])) / area;
        in &= w[i] >= -reach[i];
      }
      if (in) body(x, y, w);
    }
  }
}

}  // namespace aligngs
