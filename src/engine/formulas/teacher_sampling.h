// The semantic teacher at one pixel of the image: where its probabilities come from and whether they count. The one
// definition of a valid pixel, used by every engine.
#pragma once

#include <cmath>

#include "core/half.h"
#include "engine/training_view.h"

namespace aligngs {

/// Up to four pixels of the teacher's map and the weights of their stored numbers: what is sampled with them sums to 1
/// when valid.
struct TeacherTaps {
  int pixel[4] = {0, 0, 0, 0};     ///< y * width + x in the teacher's map
  float weight[4] = {0, 0, 0, 0};  ///< bilinear, times SemanticTarget::scale
  bool valid = false;              ///< false: the pixel has no semantic loss and is not counted
};

/// The size of a teacher's map, its confidences and SemanticTarget::scale, [height][width] each; nullptr: 1 everywhere.
struct TeacherGrid {
  int width = 0, height = 0;
  const float* confidence = nullptr;
  const float* scale = nullptr;
};

/// Bilinear at pixel centres (half-pixel rule, source = (x + 0.5) * source_width / width - 0.5), over the taps whose
/// confidence is > 0 only. Valid where those hold at least half of the bilinear weight. A teacher of the image's own
/// size gives exactly its own pixel. The map must not be empty.
ALIGNGS_HD inline TeacherTaps teacher_taps(const TeacherGrid& grid, int x, int y, int width, int height) {
  using std::floor;
  TeacherTaps taps;
  const double sx = (x + 0.5) * grid.width / width - 0.5, sy = (y + 0.5) * grid.height / height - 0.5;
  const double fx = floor(sx), fy = floor(sy);
  const double ax = sx - fx, ay = sy - fy;
  double sum = 0, weights[4];
  for (int k = 0; k < 4; ++k) {
    int px = static_cast<int>(fx) + (k & 1), py = static_cast<int>(fy) + (k >> 1);
    px = px < 0 ? 0 : (px >= grid.width ? grid.width - 1 : px);
    py = py < 0 ? 0 : (py >= grid.height ? grid.height - 1 : py);
    taps.pixel[k] = py * grid.width + px;
    weights[k] = ((k & 1) ? ax : 1 - ax) * ((k >> 1) ? ay : 1 - ay);
    if (grid.confidence != nullptr && !(grid.confidence[taps.pixel[k]] > 0)) weights[k] = 0;
    sum += weights[k];
  }
  taps.valid = sum >= 0.5;
  if (!taps.valid) return taps;
  for (int k = 0; k < 4; ++k) {
    taps.weight[k] = static_cast<float>(weights[k] / sum) * (grid.scale != nullptr ? grid.scale[taps.pixel[k]] : 1.0f);
  }
  return taps;
}

/// The same for a target; not valid where it is empty.
inline TeacherTaps teacher_taps(const SemanticTarget& target, int x, int y, int width, int height) {
  if (target.empty()) return {};
  const TeacherGrid grid{target.width, target.height, target.confidence.empty() ? nullptr : target.confidence.data(),
                         target.scale.empty() ? nullptr : target.scale.data()};
  return teacher_taps(grid, x, y, width, height);
}

/// True where the pixel takes part in the semantic loss: the teacher speaks and the image's mask keeps the pixel.
inline bool semantic_pixel_valid(const ViewData& view, const TeacherTaps& taps, int x, int y) {
  return taps.valid && (view.mask.empty() || view.mask.at(x, y) > 0.5f);
}

/// The number of valid pixels of a view, by which the semantic loss is averaged. It depends on the teacher and the
/// mask only, so an engine may compute it once per view.
inline size_t count_semantic_pixels(const ViewData& view) {
  size_t count = 0;
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      const TeacherTaps taps = teacher_taps(view.semantics, x, y, view.camera.width, view.camera.height);
      count += semantic_pixel_valid(view, taps, x, y) ? 1 : 0;
    }
  }
  return count;
}

/// Writes the teacher's C probabilities at valid taps: t_c = sum_k weight_k p_k,c, in float in tap order.
inline void sample_teacher(const SemanticTarget& target, const TeacherTaps& taps, float* out) {
  for (int c = 0; c < target.channels; ++c) out[c] = 0;
  for (int k = 0; k < 4; ++k) {
    if (taps.weight[k] == 0) continue;
    const uint16_t* row = &target.probabilities[size_t(taps.pixel[k]) * target.channels];
    for (int c = 0; c < target.channels; ++c) out[c] += taps.weight[k] * half_to_float(row[c]);
  }
}

}  // namespace aligngs
