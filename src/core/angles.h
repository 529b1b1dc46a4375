// Degrees and radians.
#pragma once

namespace aligngs {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadiansPerDegree = kPi / 180;
inline constexpr double kDegreesPerRadian = 180 / kPi;

}  // namespace aligngs
