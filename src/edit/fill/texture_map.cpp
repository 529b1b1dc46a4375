#include "edit/fill/texture_map.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

/// Mean of the colours that cover each cell, as a renderer mixes them: one Gaussian alone is more colourful than its
/// surface.
TextureMap mean_colors(const PlaneGrid& grid, const std::vector<KnownColor>& known) {
  constexpr double kReach = 2.5;  // standard deviations
  constexpr float kLeast = 0.1f;  // weight of a cell that is covered
  TextureMap map{grid.columns, grid.rows, std::vector<Vec3f>(grid.size()), std::vector<float>(grid.size(), 0.f)};
  for (const KnownColor& k : known) {
    const double r = kReach * k.radius;
    const int low_i = std::max(0, static_cast<int>(std::floor(k.place.x - r))),
              high_i = std::min(grid.columns - 1, static_cast<int>(std::floor(k.place.x + r))),
              low_j = std::max(0, static_cast<int>(std::floor(k.place.y - r))),
              high_j = std::min(grid.rows - 1, static_cast<int>(std::floor(k.place.y + r)));
    for (int j = low_j; j <= high_j; ++j) {
      for (int i = low_i; i <= high_i; ++i) {
        const double dx = i + 0.5 - k.place.x, dy = j + 0.5 - k.place.y;
        const double fall = k.radius > 0 ? std::exp(-0.5 * (dx * dx + dy * dy) / (k.radius * k.radius)) : 1;
        const float weight = k.weight * static_cast<float>(fall);
        map.value[map.index(i, j)] += k.color * weight;
        map.mask[map.index(i, j)] += weight;
      }
    }
  }
  for (size_t at = 0; at < map.mask.size(); ++at) {
    const float weight = map.mask[at];
    map.mask[at] = weight >= kLeast ? 1.f : 0.f;
    map.value[at] = weight >= kLeast ? map.value[at] * (1 / weight) : Vec3f{};
  }
  return map;
}

/// Running mean over 2 r + 1 cells along rows or columns; zeros outside.
void box_blur(std::vector<float>& values, const TextureMap& map, int radius, bool along_rows) {
  const int lines = along_rows ? map.rows : map.columns, length = along_rows ? map.columns : map.rows;
  std::vector<double> sums(static_cast<size_t>(length) + 1);
  for (int l = 0; l < lines; ++l) {
    const auto at = [&](int k) { return along_rows ? map.index(k, l) : map.index(l, k); };
    sums[0] = 0;
    for (int k = 0; k < length; ++k)
      sums[static_cast<size_t>(k) + 1] = sums[static_cast<size_t>(k)] + static_cast<double>(values[at(k)]);
    for (int k = 0; k < length; ++k) {
      const size_t begin = static_cast<size_t>(std::max(0, k - radius));
      const size_t end = static_cast<size_t>(std::min(length, k + radius + 1));
      values[at(k)] = static_cast<float>((sums[end] - sums[begin]) / (2 * radius + 1));
    }
  }
}

/// About a Gaussian of standard deviation `sigma` cells: three running means (Wells 1986).
void blur(std::vector<float>& values, const TextureMap& map, double sigma) {
  const int radius = std::max(1, static_cast<int>(std::lround(sigma)));  // three boxes of 2 r + 1 have sigma r + 1/2
  for (int pass = 0; pass < 3; ++pass) {
    box_blur(values, map, radius, true);
    box_blur(values, map, radius, false);
  }
}

/// Takes the light away: the blurred colours of the known cells.
void subtract_light(TextureMap& map, double sigma) {
  std::vector<float> weight = map.mask;
  blur(weight, map, sigma);
  for (int c = 0; c < 3; ++c) {
    std::vector<float> channel(map.value.size());
    for (size_t at = 0; at < channel.size(); ++at) channel[at] = map.mask[at] > 0 ? map.value[at][c] : 0.f;
    blur(channel, map, sigma);
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
