// The unit in which texts give lengths of a room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/vec.h"
#include "scene/scene.h"

namespace aligngs {

struct LengthUnit {
  std::optional<double> metres;  ///< of a scene unit; absent: nothing tells the scale
  bool estimated = false;        ///< a network estimates the metres
};

/// The scale of room.json, which may be one that a person gave. Without such a file: that of the scene. Error{kBadInput}
/// for a room.json that cannot be read.
LengthUnit length_unit_of(const std::filesystem::path& run, const Scene& scene);

/// "46 cm", "46 cm (estimated)" or "0.46 scene units".
std::string length_text(double length, const LengthUnit& unit);

/// The same as edits by words take it: "46 cm" or "0.46".
std::string length_to_type(double length, const LengthUnit& unit);

/// "77 x 75 x 91 cm"; in scene units "0.77 x 0.75 x 0.91 units".
std::string sides_text(const Vec3d& sides, const LengthUnit& unit);

}  // namespace aligngs
