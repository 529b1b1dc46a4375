// The zero surface of a TSDF as a triangle mesh.
#pragma once

#include "core/thread_pool.h"
#include "mesh/tsdf_volume.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct MarchingCubesOptions {
  /// A cube yields surface when each of its eight corners has at least this weight.
  double min_weight = 1e-6;
};

/// Lorensen and Cline 1987. Vertices are shared by all cubes around them, across blocks. Normals are the interpolated
/// gradients of the field and point to free space. Triangles are counter-clockwise seen from there. Colours are
/// interpolated where the field has some, grey elsewhere. The order of vertices and triangles depends on the field
/// alone. Error{kResources} when the mesh and the blocks together exceed the volume's budget.
TriangleMesh extract_surface(const TsdfVolume& volume, ThreadPool& pool, const MarchingCubesOptions& options = {});

}  // namespace aligngs
