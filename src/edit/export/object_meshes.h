// A room's mesh, cut into one mesh per object.
#pragma once

#include <array>
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
  std::vector<std::array<float, 2>> uv;  ///< per vertex, in the texture, (0, 0) at its top left; empty without one
};

/// Vertices that are far from all objects of their class, while another object is there: mistakes of the mesh.
enum class StrayVertices {
  kJoinOthers,  ///< each is of the object that is there
  kNoObject,    ///< they stay of their class, with the number 0: a box around an object has no use for them
};

/// Every triangle goes to exactly one object: the majority class of its vertices, and of that class the object whose
/// Gaussians are nearest. By class, then number; what has no class comes last.
std::vector<ObjectMesh> object_meshes(const EditableRoom& room, ThreadPool& pool,
                                      StrayVertices strays = StrayVertices::kJoinOthers);
/// The same of another mesh of the room.
std::vector<ObjectMesh> object_meshes(const TriangleMesh& mesh, const LabelledGaussians& gaussians,
                                      const LabelSet& classes, ThreadPool& pool,
                                      StrayVertices strays = StrayVertices::kJoinOthers);

}  // namespace aligngs
