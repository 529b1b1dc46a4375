#include "edit/fill/texture_map.h"

#include <algorithm>
#include <cmath>

#include "edit/fill/blurred_cells.h"

namespace aligngs {
namespace {

/// Adds a colour to the cells that it covers, as a flat Gaussian.
void add_color(const KnownColor& known, TextureMap& map) {
  constexpr double kReach = 2.5;  // standard deviations
  const CellSpread& s = known.spread;
  const double determinant = s.xx * s.yy - s.xy * s.xy;
  if (!std::isfinite(determinant)) return;
  const bool is_wide = determinant > 0;
  const double rx = is_wide ? kReach * std::sqrt(s.xx) : 0, ry = is_wide ? kReach * std::sqrt(s.yy) : 0;
  const double low_x = known.place.x - rx, high_x = known.place.x + rx, low_y = known.place.y - ry,
               high_y = known.place.y + ry;
  if (!(high_x >= 0 && low_x < map.columns && high_y >= 0 && low_y < map.rows)) return;
  const int low_i = static_cast<int>(std::max(0.0, low_x)), low_j = static_cast<int>(std::max(0.0, low_y)),
            high_i = static_cast<int>(std::min(map.columns - 1.0, high_x)),
            high_j = static_cast<int>(std::min(map.rows - 1.0, high_y));
  for (int j = low_j; j <= high_j; ++j) {
    for (int i = low_i; i <= high_i; ++i) {
      const double x = i + 0.5 - known.place.x, y = j + 0.5 - known.place.y;
      const double distance = is_wide ? (s.yy * x * x - 2 * s.xy * x * y + s.xx * y * y) / determinant : 0;
      const float weight = known.weight * static_cast<float>(std::exp(-0.5 * distance));
      map.value[map.index(i, j)] += known.color * weight;
      map.mask[map.index(i, j)] += weight;
    }
  }
}

/// Mean of the colours that cover each cell, as a renderer mixes them: one Gaussian alone is more colourful than its
/// surface.
TextureMap mean_colors(const PlaneGrid& grid, const std::vector<KnownColor>& known) {
  constexpr float kLeast = 0.1f;  // weight of a cell that is covered
  TextureMap map{grid.columns, grid.rows, std::vector<Vec3f>(grid.size()), std::vector<float>(grid.size(), 0.f)};
  for (const KnownColor& k : known) add_color(k, map);
  for (size_t at = 0; at < map.mask.size(); ++at) {
    const float weight = map.mask[at];
    map.mask[at] = weight >= kLeast ? 1.f : 0.f;
    map.value[at] = weight >= kLeast ? map.value[at] * (1 / weight) : Vec3f{};
  }
  return map;
}

/// Takes the light away: the blurred colours of the known cells.
void subtract_light(TextureMap& map, double sigma) {
  std::vector<float> weight = map.mask;
  blur_cells(weight, map.columns, map.rows, sigma);
  for (int c = 0; c < 3; ++c) {
    std::vector<float> channel(map.value.size());
    for (size_t at = 0; at < channel.size(); ++at) channel[at] = map.mask[at] > 0 ? map.value[at][c] : 0.f;
    blur_cells(channel, map.columns, map.rows, sigma);
    for (size_t at = 0; at < channel.size(); ++at) {
      if (map.mask[at] > 0) map.value[at][c] -= channel[at] / weight[at];
    }
  }
}

}  // namespace

float contrast_of(const TextureMap& map) {
  constexpr float kNormal = 1.4826f;  // of a normal distribution: standard deviation over median of the size
  std::vector<float> lengths;
  for (size_t at = 0; at < map.mask.size(); ++at) {
    if (map.mask[at] > 0) lengths.push_back(norm(map.value[at]));
  }
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return kNormal * *middle;
}

TextureMap texture_map(const PlaneGrid& grid, const std::vector<KnownColor>& known,
                       const TextureMapSettings& settings) {
  TextureMap map = mean_colors(grid, known);
  subtract_light(map, settings.light / grid.cell);
  const float longest = settings.spreads * contrast_of(map);
  for (Vec3f& value : map.value) {
    const float length = norm(value);
    if (length > longest && length > 0) value = value * (longest / length);
  }
  return map;
}

}  // namespace aligngs
