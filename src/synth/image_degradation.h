// Effects of a phone's camera on a perfect picture.
#pragma once

#include <array>
#include <cstddef>

#include "core/image.h"
#include "core/random.h"

namespace aligngs {

/// Effects of a hand-held camera on photos of a room; the shares are judgement.
struct ImageDegradationSettings {
  double noise = 1.5 / 255;     ///< standard deviation at medium brightness; grows with the square root of it
  double blur = 1.5;            ///< largest width of the blur (full width at half maximum), pixels
  double gain = 0.12;           ///< exposure per view: +- this share, linear light
  double white_balance = 0.03;  ///< red and blue against green per view: +- this share
  int jpeg_quality = 92;
  /// further exposure of red, green and blue: logarithm of a factor, linear light
  std::array<double, 3> log_gain{};
};

/// Automatic exposure and white balance of the `index`-th photo of a walk. They drift between neighbours, as on a phone
/// that turns from a window to a dark corner. They stay within a factor of two per channel.
std::array<double, 3> exposure_walk(Random random, size_t index);

/// Factors of red, green and blue, linear light, that degrade_image() applies with the same settings and numbers.
std::array<double, 3> photo_gains(const ImageDegradationSettings& settings, Random random);

/// Applies exposure and white balance (linear light), blur, noise, and one JPEG coding. `color` is sRGB in [0, 1].
Image<uint8_t> degrade_image(const ImageF& color, const ImageDegradationSettings& settings, Random random);

}  // namespace aligngs
