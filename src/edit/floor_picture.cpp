#include "edit/floor_picture.h"

#include <algorithm>

#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr int kGapRounds = 2;  ///< cells without a Gaussian get the mean of their neighbours so many times

using Channels = std::array<std::vector<float>, 3>;

/// Gives cells without a Gaussian the sums of their neighbours.
void fill_gaps(const PlaneGrid& grid, std::vector<float>& count, Channels& color) {
  const SquareSums counts(grid, count), red(grid, color[0]), green(grid, color[1]), blue(grid, color[2]);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const size_t cell = grid.index(column, row);
      if (count[cell] > 0) continue;
      count[cell] = static_cast<float>(counts.around(column, row, 1));
      color[0][cell] = static_cast<float>(red.around(column, row, 1));
      color[1][cell] = static_cast<float>(green.around(column, row, 1));
      color[2][cell] = static_cast<float>(blue.around(column, row, 1));
    }
  }
}

}  // namespace

FloorPicture paint_floor(const GaussianModel& model, const std::vector<uint32_t>& rows, const PlaneOf& plane,
                         double cell) {
  FloorPicture out;
  std::vector<Vec3d> places;
  for (const uint32_t row : rows) places.push_back(position_of(model, row));
  out.grid = grid_over(places, plane, cell, cell);
  std::vector<float> count(out.grid.size(), 0);
  for (auto& channel : out.color) channel.assign(out.grid.size(), 0);
  for (size_t k = 0; k < rows.size(); ++k) {
    const auto at = out.grid.cell_at(out.grid.place_of(places[k]));
    if (!at || opacity_of(model, rows[k]) < kSolidOpacity) continue;
    const Vec3f color = base_color_of(model, rows[k]);
    for (int c = 0; c < 3; ++c) out.color[static_cast<size_t>(c)][*at] += std::clamp(color[c], 0.0f, 1.0f);
    count[*at] += 1;
  }
  for (int round = 0; round < kGapRounds; ++round) fill_gaps(out.grid, count, out.color);
  out.seen.resize(count.size());
  out.shade.assign(count.size(), 0);
  for (size_t i = 0; i < count.size(); ++i) {
    out.seen[i] = count[i] > 0;
    for (size_t c = 0; out.seen[i] && c < 3; ++c) {
      out.color[c][i] /= count[i];
      const int level = std::min(static_cast<int>(out.color[c][i] * kFloorLevels), kFloorLevels - 1);
      out.shade[i] = static_cast<uint16_t>(out.shade[i] * kFloorLevels + level);
    }
  }
  return out;
}

}  // namespace aligngs
