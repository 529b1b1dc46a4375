// Small functions of textures, pictures and shading.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/vec.h"

namespace aligngs {

inline constexpr float kPiFloat = static_cast<float>(kPi);

/// From a at t = 0 to b at t = 1.
inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }

inline float clamp01(float x) { return std::clamp(x, 0.0f, 1.0f); }

/// In [0, 1): what is left of x above the next lower integer.
inline float fraction(float x) { return x - std::floor(x); }

}  // namespace aligngs
