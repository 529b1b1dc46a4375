// How photos of the same room differ in exposure and white balance, measured where they show the same surface.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/guided_match.h"

namespace aligngs {

/// One photo; maps are H x W of the camera's size.
struct ExposureView {
  const MatchView* match = nullptr;  ///< camera and depth, which must be nearly right
  const ImageF* color = nullptr;     ///< H x W x 3, sRGB in [0, 1]
  const ImageF* mask = nullptr;      ///< 0 = do not use this pixel; may be empty
};

struct ExposureSettings {
  int step = 3;                             ///< pixels between samples
  int neighbours = 8;                       ///< photos that one is compared with: those that see most of the same
  double least_overlap = 0.1;               ///< of a photo's pixels inside of the other
  double largest_turn = 75;                 ///< degrees between viewing directions
  double depth_agreement = 0.02;            ///< relative: both photos must see the same surface
  double darkest = 0.05, brightest = 0.95;  ///< sRGB: outside, noise and clipping decide
  int least_samples = 100;                  ///< of a pair of photos; with fewer it says nothing
  double no_change = 0.05;                  ///< weight of a gain of 1 beside the pairs of a photo, each 1
  /// |log gain| beyond which it is no exposure: a factor of 5, as automatic exposure against a window
  double largest = 1.6;
};

/// Logarithms of red, green and blue gains in linear light, one per view, their mean 0. From each pair the median ratio
/// of light over what both see; from all pairs the gains by least squares. A photo that is compared with none, or lacks
/// depth, gets zeros. Deterministic for any number of threads.
std::vector<Vec3f> estimate_log_gains(const std::vector<ExposureView>& views, const ExposureSettings& settings,
                                      ThreadPool& pool);

}  // namespace aligngs
