// Order of a mesh in which neighbours follow each other, so that its numbers compress well (meshoptimizer).
#pragma once

#include "scene/triangle_mesh.h"

namespace aligngs {

/// Sorts triangles along the surface, and vertices by their first use. The first corner of a triangle may be another
/// one; its side stays. Vertices that no triangle uses go, with their attributes.
void order_by_neighbours(TriangleMesh& mesh);

}  // namespace aligngs
