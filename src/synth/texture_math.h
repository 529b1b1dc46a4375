// Small functions of textures and pictures.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"

namespace aligngs {

inline constexpr float kTexturePi = 3.14159265f;

/// From a at t = 0 to b at t = 1.
inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }

inline float clamp01(float x) { return std::clamp(x, 0.0f, 1.0f); }

/// In [0, 1): what is left of x above the next lower integer.
inline float fraction(float x) { return x - std::floor(x); }

}  // namespace aligngs
