// The direction that is up in a trained room.
#pragma once

#include <optional>

#include "edit/selection.h"
#include "scene/scene.h"

namespace aligngs {

/// The scene's up; where scene.json has none, what the Gaussians labelled as floor, the scene's points and its cameras
/// say (scene/up_direction.h). Empty when they say nothing.
std::optional<Vec3d> up_of_room(const Scene& scene, const LabelledGaussians& gaussians);

}  // namespace aligngs
