// A room's mesh, cut into one mesh per object.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

struct ObjectMesh {
  std::string name;        ///< "pillow.002", "wall.001"; "unlabelled" for the rest
  std::string class_name;  ///< empty without a class
  int label = -1;          ///< class number
  int instance = 0;        ///< 0: surface of the class that belongs to no numbered object
  TriangleMesh mesh;
};

/// Every triangle goes to exactly one object: the majority class of its vertices, and of that class the object whose
/// Gaussians are nearest. By class, then number; what has no class comes last.
std::vector<ObjectMesh> object_meshes(const EditableRoom& room, ThreadPool& pool);

}  // namespace aligngs
