// The place from which the page shows a room first.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "core/vec.h"

namespace aligngs {

struct StartPose {
  Vec3d eye, target;  ///< scene units, world; apart from each other
  Vec3d up;           ///< unit, world
};

/// From the photo's place that is farthest from what the photos look at, towards that.
/// `cameras`: the content of cameras.json. `up`: three numbers, or null: the mean up of the photos.
/// Nothing where that is no list of cameras, and where all photos look in one direction.
std::optional<StartPose> start_pose(const nlohmann::json& cameras, const nlohmann::json& up);

/// {"eye": [x, y, z], "target": [x, y, z]}, or null.
nlohmann::json start_pose_json(const std::optional<StartPose>& pose);

}  // namespace aligngs
