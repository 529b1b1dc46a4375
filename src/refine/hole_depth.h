// Depth where a sensor measured nothing: black and shining things, glass, what lies beyond its range.
#pragma once

#include <functional>
#include <vector>

#include "refine/photo_depth.h"

namespace aligngs {

struct HoleDepthSettings {
  PhotoDepthSettings stereo;
  /// median |log ratio| of stereo and sensor in a photo, beyond which its stereo is not used
  double largest_disagreement = 0.05;
  int least_common = 500;  ///< pixels that both measured, to tell that
};

struct HoleDepth {
  /// H x W: the sensor's where it has any, else that of stereo where another photo confirms it, else 0
  ImageF depth;
  /// H x W: 1 for the sensor, up to kFilledConfidence for stereo by its certainty, 0 without depth
  ImageF confidence;
  double filled = 0;  ///< share of the pixels that stereo filled
  /// median |log ratio| of both, where both measured; 0 with fewer than least_common such pixels
  double disagreement = 0;
};

/// A sensor errs by a percent, stereo between few photos by several.
inline constexpr float kFilledConfidence = 0.5f;

/// `views`: camera, luma and sensor depth (0 = none). `points`: as for photo_depth(). Deterministic for any number of
/// threads.
std::vector<HoleDepth> fill_depth_holes(const std::vector<MatchView>& views, const std::vector<Vec3f>& points,
                                        const HoleDepthSettings& settings, ThreadPool& pool,
                                        const std::function<void(double share)>& progress = {});

}  // namespace aligngs
