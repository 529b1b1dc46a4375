// How well other photos agree with each of many small changes of a photo's prior depth.
#pragma once

#include <cstdint>
#include <vector>

#include "refine/guided_match.h"

namespace aligngs {

struct SweepSettings {
  int hypotheses = 41;  ///< factors on the prior depth, odd: the middle one is 1
  double range = 0.1;   ///< largest |log factor|
  int half_window = 3;  ///< pixels to each side that are compared
  int best = 2;         ///< photos whose agreement counts: the others may not see the place at all
  /// standard deviation of a window's luma, a step of 8 bits or so; below it nothing can be told
  double least_contrast = 0.005;
  double least_share = 0.6;  ///< of a window's pixels that must fall into the other photo

  /// log factor of a hypothesis, which may lie between two of them.
  double log_factor(double hypothesis) const {
    const double middle = 0.5 * (hypotheses - 1);
    return middle > 0 ? range * (hypothesis - middle) / middle : 0;
  }
};

/// 1 - normalised cross-correlation, from 0 (alike) to 2, for every pixel and hypothesis.
struct CostVolume {
  static constexpr float kUnknown = 1;  ///< what a pixel costs, at every hypothesis, that no photo tells anything about
  int width = 0, height = 0, hypotheses = 0;
  std::vector<float> cost;     ///< [y][x][hypothesis]
  std::vector<uint8_t> known;  ///< [y][x] 1: at least one other photo was compared

  const float* at(int x, int y) const { return &cost[(static_cast<size_t>(y) * width + x) * hypotheses]; }
  float* at(int x, int y) { return &cost[(static_cast<size_t>(y) * width + x) * hypotheses]; }
};

/// Every pixel of `view` is carried into the other photos by its own prior depth times the factor. A window hence
/// follows slanted surfaces and both sides of a depth edge. Windows are compared there. Pixels without depth are
/// unknown.
CostVolume sweep_prior_depth(const MatchView& view, const std::vector<const MatchView*>& others,
                             const SweepSettings& settings);

}  // namespace aligngs
