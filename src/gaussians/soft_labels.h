// Class probabilities of the Gaussians, and the labels that follow.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/gaussian_ply.h"
#include "scene/label_set.h"

namespace aligngs {

/// The kTop most probable classes of each Gaussian, best first. The rest of 1 belongs to the other classes.
struct SoftLabels {
  static constexpr size_t kTop = 8;  ///< beyond the eighth class of a room nothing has weight; 48 bytes a Gaussian
  std::vector<uint16_t> label;       ///< [N][kTop]; kNoLabel: no further class
  std::vector<float> probability;    ///< [N][kTop]

  size_t size() const { return label.size() / kTop; }
  float of(size_t gaussian, int wanted) const;  ///< 0 when not among the best
};

/// softmax of the semantic rows; rows that no pixel taught (all equal) have no class.
SoftLabels soft_labels(const GaussianModel& model, ThreadPool& pool);

/// Best class and its probability; instances are 0.
GaussianLabels best_labels(const SoftLabels& soft, const LabelSet& labels);

/// Positions as vectors.
std::vector<Vec3f> positions_of(const GaussianModel& model);
/// Half the diagonal of the box between the 5 % and 95 % quantiles of the positions; never zero. The same measure as
/// robust_extent of a scene, for code that has only the Gaussians.
double extent_of(const GaussianModel& model);
float opacity_of(const GaussianModel& model, size_t i);
/// Colour of the constant spherical harmonic, sRGB, not clamped.
Vec3f base_color_of(const GaussianModel& model, size_t i);

}  // namespace aligngs
