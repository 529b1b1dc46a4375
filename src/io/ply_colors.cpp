#include "io/ply_colors.h"

namespace aligngs {
namespace {

/// The largest value of a channel.
double full_scale(PlyType type) {
  switch (type) {
    case PlyType::kFloat32:
    case PlyType::kFloat64:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 65535;
    default:
      return 255;
  }
}

}  // namespace

std::vector<Vec3f> ply_colors(const PlyElement& vertices) {
  constexpr const char* kNames[2][3] = {{"red", "green", "blue"}, {"r", "g", "b"}};
  for (const auto& names : kNames) {
    const PlyProperty* channel[3];
    bool all = true;
    for (int k = 0; k < 3; ++k) {
      channel[k] = vertices.find(names[k]);
      all = all && channel[k] != nullptr && !channel[k]->is_list;
    }
    if (!all) continue;
    std::vector<Vec3f> colors(vertices.count);
    for (size_t i = 0; i < colors.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const double value = channel[k]->values[i] / full_scale(channel[k]->type);
        colors[i][k] = value > 0 ? (value < 1 ? static_cast<float>(value) : 1.0f) : 0.0f;  // also takes NaN to 0
      }
    }
    return colors;
  }
  return {};
}

}  // namespace aligngs
