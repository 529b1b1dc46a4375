// The transfer function of sRGB (IEC 61966-2-1): what files and screens hold, and light.
#pragma once

#include <algorithm>
#include <cmath>

namespace aligngs {

/// Linear light [0, 1] to sRGB [0, 1]; beyond is cut off.
inline float srgb_encode(float linear) {
  const float x = std::min(std::max(linear, 0.0f), 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

/// sRGB [0, 1] to linear light [0, 1]; beyond is cut off.
inline float srgb_decode(float srgb) {
  const float x = std::min(std::max(srgb, 0.0f), 1.0f);
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

}  // namespace aligngs
