// A smooth correction of a view's prior depth: what feed-forward depth has wrong is bent, not noisy.
#pragma once

#include <array>
#include <vector>

#include "core/image.h"
#include "core/vec.h"

namespace aligngs {

/// Factor exp(g(u, v)) with g bilinear between 4 x 3 nodes over the image.
struct DepthGrid {
  static constexpr int kColumns = 4, kRows = 3;
  std::array<double, kColumns * kRows> log_factor{};  ///< row by row from the top left; all 0: no correction

  /// x and y in [0, 1] over the image.
  double at(double x, double y) const;
  /// Multiplies valid pixels (> 0, finite).
  void apply(ImageF& depth) const;
};

/// One place of the view where the depth is known from elsewhere.
struct DepthGridSample {
  double x = 0, y = 0;   ///< in [0, 1] over the image
  double log_ratio = 0;  ///< log(known / prior)
};

struct DepthGridSettings {
  double sigma = 0.02;       ///< of a sample, log units
  double smoothness = 0.02;  ///< of the difference between neighbouring nodes
  double deviation = 0.05;   ///< of a node from no correction
  double limit = 0.15;       ///< |log factor| of a node
  size_t min_samples = 12;   ///< fewer than the nodes determine little: no correction
};

/// Robust least squares (Huber, reweighted). Nodes without samples near them follow their neighbours.
DepthGrid fit_depth_grid(const std::vector<DepthGridSample>& samples, const DepthGridSettings& settings = {});

}  // namespace aligngs
