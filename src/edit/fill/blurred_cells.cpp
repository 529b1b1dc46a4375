#include "edit/fill/blurred_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace aligngs {
namespace {

/// Running mean of 2 r + 1 values along a line of cells that lie `stride` apart; zeros outside.
void running_mean(float* line, int length, size_t stride, int radius, std::vector<double>& sums) {
  sums[0] = 0;
  for (int k = 0; k < length; ++k) {
    const size_t at = static_cast<size_t>(k);
    sums[at + 1] = sums[at] + static_cast<double>(line[at * stride]);
  }
  for (int k = 0; k < length; ++k) {
    const size_t begin = static_cast<size_t>(std::max(0, k - radius));
    const size_t end = static_cast<size_t>(std::min(length, k + radius + 1));
    line[static_cast<size_t>(k) * stride] = static_cast<float>((sums[end] - sums[begin]) / (2 * radius + 1));
  }
}

}  // namespace

void blur_cells(std::vector<float>& values, int columns, int rows, double sigma) {
  const int radius = std::max(1, static_cast<int>(std::lround(sigma)));  // three boxes of 2 r + 1 have sigma r + 1/2
  const size_t width = static_cast<size_t>(columns);
  std::vector<double> sums(static_cast<size_t>(std::max(columns, rows)) + 1);
  for (int pass = 0; pass < 3; ++pass) {
    for (int j = 0; j < rows; ++j)
      running_mean(values.data() + static_cast<size_t>(j) * width, columns, 1, radius, sums);
    for (size_t i = 0; i < width; ++i) running_mean(values.data() + i, rows, width, radius, sums);
  }
}

}  // namespace aligngs
