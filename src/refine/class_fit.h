// Classes that belong on a plane are those that were measured there.
#pragma once

#include <vector>

#include "refine/measured_planes.h"

namespace aligngs {

struct ClassFitSettings {
  double reach = 0.015;       ///< relative distance from a plane within which a measured pixel lies on it
  double usual_share = 0.05;  ///< of the labelled pixels on a plane: a class with this share or more belongs there
};

/// For each plane, by class: how well the class fits it, in [0, 1]. It is the class's share of the measured pixels on
/// the plane, as a part of `usual_share`, 1 at most. Classes beyond the end of a list, and kNoLabel, were never
/// measured on it. Planes without a labelled pixel have an empty list. Only the side that a camera faces counts.
std::vector<std::vector<float>> class_fit(const std::vector<MeasuredView>& views, const std::vector<ScenePlane>& planes,
                                          const ClassFitSettings& settings);

}  // namespace aligngs
