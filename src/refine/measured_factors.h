// Corrections of the photos' depth by what is measured: multi-view stereo and the planes of the room.
#pragma once

#include <vector>

#include "core/image.h"
#include "refine/refined_scene.h"

namespace aligngs {

/// Whether planes of the room are looked for: they need labels.
bool uses_planes(const Scene& scene, const RefineSceneOptions& options);

/// Maps of each training photo, at its size.
struct MeasuredFactors {
  std::vector<ImageF> log_factors;  ///< on its depth
  std::vector<ImageF> certainty;    ///< of its measurements, >= 0; an empty image: it has none
};

/// Log factors on the grid-corrected depth of each training view; empty images: none. `labels` are those of the photos,
/// read only where planes are looked for. Fills in what the report says of stereo and planes.
MeasuredFactors measured_factors(const Scene& scene, const std::vector<MatchView>& photos,
                                 const std::vector<Image<uint16_t>>& labels, const RefineSceneOptions& options,
                                 ThreadPool& pool, RefineSceneReport& report);

}  // namespace aligngs
