// The depth maps of a sensor in a scene folder, read, cleaned and written at their own size.
#pragma once

#include <filesystem>

#include "refine/sensor_depth.h"
#include "scene/scene.h"

namespace aligngs {

/// pred_depths/ and, where it is there, pred_confidence/ of a view, cleaned. `luma` of its photo may have another size.
/// Error{kBadInput} names a map that is none.
SensorDepth clean_sensor_maps(const Scene& scene, int view, const ImageF& luma, const SensorDepthSettings& settings);

/// Puts them in the place of the view's maps in `folder`, a copy of the scene's.
void write_sensor_maps(const Scene& scene, int view, const SensorDepth& maps, const std::filesystem::path& folder);

}  // namespace aligngs
