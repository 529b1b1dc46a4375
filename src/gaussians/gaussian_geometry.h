// Place and direction of one Gaussian of a model, and when it is seen at all.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/rigid.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/soft_labels.h"

namespace aligngs {

/// Gaussians below are never drawn: alpha_min of the rasteriser.
inline constexpr float kInvisibleOpacity = 1.0f / 255;

/// The rows that are drawn at all.
inline std::vector<uint32_t> visible_rows(const GaussianModel& model) {
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) >= kInvisibleOpacity) rows.push_back(i);
  }
  return rows;
}

/// Centre of row i, world.
inline Vec3d position_of(const GaussianModel& model, size_t i) {
  return {model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
}

/// The shortest axis of row i, unit, world: the normal of a flat Gaussian, up to its sign.
inline Vec3d shortest_axis(const GaussianModel& model, size_t i) {
  const float* s = &model.log_scales[3 * i];
  const float* q = &model.rotations[4 * i];
  const int shortest = static_cast<int>(std::min_element(s, s + 3) - s);
  return rotation_matrix(normalized(Quaterniond{q[0], q[1], q[2], q[3]})).column(shortest);
}

}  // namespace aligngs
