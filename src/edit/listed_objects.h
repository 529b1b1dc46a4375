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

}  // namespace aligngs
