// A sentence about the cameras that refinement found.
#pragma once

#include <string>

#include "refine/refine_cameras.h"

namespace aligngs {

/// How many tracks were adjusted, and how well the cameras fit before and after. Without tracks it tells that the
/// cameras stay, and what would change that.
std::string camera_report(const RefineResult& result);

}  // namespace aligngs
