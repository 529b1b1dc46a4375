// Every hole of a mesh closed, also where no photo has looked.
#pragma once

#include <cstddef>

#include "scene/triangle_mesh.h"

namespace aligngs {

struct ClosingReport {
  size_t holes = 0;       ///< closed
  size_t triangles = 0;   ///< added
  size_t open_edges = 0;  ///< left
};

/// Edges along which not as many triangles run in one direction as in the other. Without them the mesh is watertight.
/// Vertices at the same place are one.
size_t open_edges(const TriangleMesh& mesh);

/// Closes the borders of an oriented mesh. Vertices at the same place become one. Ears are cut off each border, the
/// shortest first that lie inside of it. A vertex in the middle closes a border whose every ear would put a third
/// triangle at an edge.
ClosingReport close_mesh(TriangleMesh& mesh);

}  // namespace aligngs
