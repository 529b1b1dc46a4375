// Places so far from all others that something else than a measurement put them there.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"

namespace aligngs {

/// For each place whether it is an outlier: more than 10000 times as far from the middle as nine tenths of all are. It is
/// more than 1000 units away as well. Fewer than four places, or most of them in one, have none. All are finite.
std::vector<bool> far_outliers(std::span<const Vec3d> places);

/// Why a camera that is one is left out.
inline constexpr const char* kFarFromOthers = "its camera is beyond all others";
inline constexpr const char* kFarFromOthersRemedy = "correct its pose, or remove it";

}  // namespace aligngs
