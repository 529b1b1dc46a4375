// Chooses the frames of a video that become photos: sharp ones, spread over the way of the camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image.h"

namespace aligngs {

/// Measures of a frame, from a small copy.
struct FrameFeatures {
  /// mean absolute Laplacian over the mean grey value; a blurred frame has less than its neighbours
  double sharpness = 0;
  double brightness = 0;  ///< mean grey value, 0 to 1
  double change = 0;      ///< from the frame before: 0 the same picture, 1 nothing in common; 0 for the first
};

/// Measures the frames of a video in their order.
class FrameMeter {
 public:
  /// `gray`: one channel, every frame of the same size. Error{kFailed} for another one.
  FrameFeatures measure(const Image<uint8_t>& gray);

 private:
  std::vector<float> before_;  ///< the frame before, small, mean 0 and variance 1: exposure plays no part in the change
};

/// Indices of at most `count` frames, in order. The way of the camera (change, and time for a quarter) is cut into
/// `count` equal pieces; the sharpest frame of each is taken. All frames when there are not more than `count`.
std::vector<size_t> choose_frames(const std::vector<FrameFeatures>& frames, size_t count);

}  // namespace aligngs
