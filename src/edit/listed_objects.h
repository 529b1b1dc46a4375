// The objects of a room with their sizes, as a list shows them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

struct ListedObject {
  Instance instance;
  std::string name;  ///< "pillow#2"
  std::optional<Vec3d>
      sides;  ///< of its upright box: length, width and height; scene units; none where up is not known
};

/// By class, then by number.
std::vector<ListedObject> listed_objects(const EditableRoom& room);

/// "77 x 75 x 91 cm"; `metres`: of a scene unit. Without them the unit is that of the scene: "0.77 x 0.75 x 0.91 units".
std::string sides_text(const Vec3d& sides, std::optional<double> metres);

}  // namespace aligngs
