#include "edit/fill/grain_map.h"

#include <algorithm>

#include "edit/fill/blurred_cells.h"

namespace aligngs {
namespace {

constexpr float kNoise = 0.3f;  // of the mean energy: directions of an even place are noise, and count little

/// Products of the changes of the brightness; 0 where a neighbour is unknown.
struct Tensor {
  std::vector<float> xx_less_yy, twice_xy, energy, known;
};

Tensor tensor_of(const TextureMap& map) {
  const size_t cells = map.value.size();
  Tensor out{std::vector<float>(cells, 0.f), std::vector<float>(cells, 0.f), std::vector<float>(cells, 0.f),
             std::vector<float>(cells, 0.f)};
  const auto brightness = [&](int i, int j) {
    const Vec3f& v = map.value[map.index(i, j)];
    return (v.x + v.y + v.z) / 3;
  };
  for (int j = 1; j + 1 < map.rows; ++j) {
    for (int i = 1; i + 1 < map.columns; ++i) {
      if (!map.knows(i, j) || !map.knows(i - 1, j) || !map.knows(i + 1, j) || !map.knows(i, j - 1) ||
          !map.knows(i, j + 1))
        continue;
      const float x = brightness(i + 1, j) - brightness(i - 1, j), y = brightness(i, j + 1) - brightness(i, j - 1);
      const size_t at = map.index(i, j);
      out.xx_less_yy[at] = x * x - y * y;
      out.twice_xy[at] = 2 * x * y;
      out.energy[at] = x * x + y * y;
      out.known[at] = 1;
    }
  }
  return out;
}

}  // namespace

TextureMap grain_map(const TextureMap& texture, double reach) {
  TextureMap out{texture.columns, texture.rows, std::vector<Vec3f>(texture.value.size()), texture.mask};
  Tensor tensor = tensor_of(texture);
  double sum = 0, count = 0;
  for (size_t at = 0; at < tensor.known.size(); ++at) {
    sum += static_cast<double>(tensor.energy[at]);
    count += static_cast<double>(tensor.known[at]);
  }
  if (!(sum > 0)) return out;
  const float noise = kNoise * static_cast<float>(sum / count);
  for (std::vector<float>* values : {&tensor.xx_less_yy, &tensor.twice_xy, &tensor.energy, &tensor.known})
    blur_cells(*values, texture.columns, texture.rows, reach);
  for (size_t at = 0; at < out.value.size(); ++at) {
    const float total = tensor.energy[at] + noise * tensor.known[at];
    if (out.mask[at] > 0 && total > 0) out.value[at] = {tensor.xx_less_yy[at] / total, tensor.twice_xy[at] / total, 0};
  }
  Vec3f mean;
  float cells = 0;
  for (size_t at = 0; at < out.value.size(); ++at) {
    mean += out.value[at] * out.mask[at];
    cells += out.mask[at];
  }
  for (size_t at = 0; at < out.value.size(); ++at) {
    if (out.mask[at] > 0) out.value[at] -= mean * (1 / cells);
  }
  return out;
}

}  // namespace aligngs
