// Classes of a photo by EoMT: windows along its long side, and the scores of all queries together.
#pragma once

#include <vector>

#include "nn/eomt/eomt.h"

namespace aligngs::nn {

/// A photo as the network is shown it: its short side is that of the window, and windows are spread evenly along the
/// other.
struct EomtWindows {
  Image<uint8_t> resized;
  std::vector<int> starts;  ///< pixels, along the height where the photo is taller than wide
  bool tall = false;
  int side = 0;  ///< of every window

  Image<uint8_t> window(size_t index) const;
};

/// RGB of 8 bits; side: of a window. Error{kBadInput} for anything else.
EomtWindows eomt_windows(const Image<uint8_t>& photo, int side);

/// The photo resized to fit a square of `side` pixels, with black to its right or below.
struct EomtPadded {
  Image<uint8_t> image;
  int width = 0, height = 0;  ///< of the photo in it
};
EomtPadded eomt_padded(const Image<uint8_t>& photo, int side);

/// Scores [side, side, classes] of one window: the sum over the queries of share of the class times share of the mask.
/// They may exceed 1.
FeatureMap eomt_window_scores(Compute& compute, const EomtPrediction& prediction, int side);

/// Scores [height, width, classes] of a photo: means over the windows, resized. At the photo's own size as published.
FeatureMap eomt_scores(Compute& compute, const Eomt& network, const Image<uint8_t>& photo, int64_t height,
                       int64_t width);

}  // namespace aligngs::nn
