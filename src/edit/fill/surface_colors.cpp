#include "edit/fill/surface_colors.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr float kKnown = 0.2f;  ///< weight above which a cell keeps its colour
constexpr int kSweeps = 60;     ///< of relaxation on every level: holes become membranes, coarse parts first

struct Level {
  int columns = 0, rows = 0;
  std::vector<Vec3f> color;   ///< premultiplied by weight while pulling
  std::vector<float> weight;  ///< in [0, 1] after pulling
  size_t index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(columns) + static_cast<size_t>(i);
  }
};

Level make_level(int columns, int rows) {
  Level level;
  level.columns = columns;
  level.rows = rows;
  level.color.resize(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  level.weight.resize(level.color.size(), 0.f);
  return level;
}

/// The mean colour where there is weight; weights above one count as one, so that many samples do not drown few.
void normalise(Level& level) {
  for (size_t i = 0; i < level.color.size(); ++i) {
    if (level.weight[i] <= 0) continue;
    level.color[i] = level.color[i] * (1 / level.weight[i]);
    level.weight[i] = std::min(1.f, level.weight[i]);
  }
}

Level half(const Level& fine) {
  Level coarse = make_level((fine.columns + 1) / 2, (fine.rows + 1) / 2);
  for (int j = 0; j < fine.rows; ++j) {
    for (int i = 0; i < fine.columns; ++i) {
      const size_t f = fine.index(i, j), c = coarse.index(i / 2, j / 2);
      coarse.color[c] += fine.color[f] * fine.weight[f];
      coarse.weight[c] += fine.weight[f];
    }
  }
  normalise(coarse);
  return coarse;
}

/// Bilinear colour of a coarse level at a place of the next finer one.
Vec3f sample(const Level& coarse, int i, int j) {
  const double x = std::clamp(0.5 * (i + 0.5) - 0.5, 0.0, coarse.columns - 1.0),
               y = std::clamp(0.5 * (j + 0.5) - 0.5, 0.0, coarse.rows - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, coarse.columns - 1), y1 = std::min(y0 + 1, coarse.rows - 1);
  const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  return coarse.color[coarse.index(x0, y0)] * ((1 - fx) * (1 - fy)) +
         coarse.color[coarse.index(x1, y0)] * (fx * (1 - fy)) + coarse.color[coarse.index(x0, y1)] * ((1 - fx) * fy) +
         coarse.color[coarse.index(x1, y1)] * (fx * fy);
}

/// Every unknown cell moves to the mean of its neighbours: the membrane with the known cells as its frame.
void relax(Level& level) {
  std::vector<Vec3f> next = level.color;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int j = 0; j < level.rows; ++j) {
      for (int i = 0; i < level.columns; ++i) {
        const size_t at = level.index(i, j);
        if (level.weight[at] > kKnown) continue;
        const Vec3f mean = (level.color[level.index(std::max(0, i - 1), j)] +
                            level.color[level.index(std::min(level.columns - 1, i + 1), j)] +
                            level.color[level.index(i, std::max(0, j - 1))] +
                            level.color[level.index(i, std::min(level.rows - 1, j + 1))]) *
                           0.25f;
        next[at] = mean;
      }
    }
    std::swap(level.color, next);
  }
}

}  // namespace

std::vector<Vec3f> continued_colors(const PlaneGrid& grid, const std::vector<KnownColor>& known) {
  std::vector<Level> levels = {make_level(grid.columns, grid.rows)};
  for (const KnownColor& k : known) {
    const std::optional<size_t> cell = grid.cell_at(k.place);
    if (!cell || !(k.weight > 0)) continue;
    levels[0].color[*cell] += k.color * k.weight;
    levels[0].weight[*cell] += k.weight;
  }
  if (std::none_of(levels[0].weight.begin(), levels[0].weight.end(), [](float w) { return w > 0; })) return {};
  normalise(levels[0]);
  while (levels.back().columns > 1 || levels.back().rows > 1) levels.push_back(half(levels.back()));
  for (size_t l = levels.size() - 1; l-- > 0;) {
    Level& fine = levels[l];
    for (int j = 0; j < fine.rows; ++j) {
      for (int i = 0; i < fine.columns; ++i) {
        const size_t at = fine.index(i, j);
        fine.color[at] = fine.color[at] * fine.weight[at] + sample(levels[l + 1], i, j) * (1 - fine.weight[at]);
      }
    }
    relax(fine);
  }
  return levels[0].color;
}

}  // namespace aligngs
