// Small holes of a mesh closed where the views have seen surface, and no view looks through.
#pragma once

#include <cstddef>
#include <vector>

#include "core/image.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Data of one view about a place: the camera and the depth that was fused (H x W, 0: none).
struct HoleWitness {
  const Camera* camera = nullptr;
  const ImageF* depth = nullptr;
};

struct HoleFillingOptions {
  double max_size = 0.15;   ///< scene units: the longest diagonal of the box around a hole; 0: none is filled
  size_t max_edges = 400;   ///< of its border
  double max_depth = 0.25;  ///< how far the border may leave its mean plane, as a share of its size
  /// scene units between a view's depth and the filling, along the ray, that count as the same surface
  double tolerance = 0.02;
};

struct HoleFillingReport {
  size_t borders = 0;  ///< closed borders of the mesh
  size_t filled = 0;
  size_t triangles = 0;  ///< added
};

/// Closes borders that are small and nearly flat by triangles around their middle. Some view must see the middle of a
/// filling, or points half-way to its border, as surface. More views must see it than look through it. Hence only seen
/// surface is closed. A border that is not star-shaped around its middle, or shares vertices with itself, stays open.
/// Attributes of the new vertex are the means of the border's; its label is none. The mesh must be oriented; the order
/// of borders follows that of the triangles.
HoleFillingReport close_seen_borders(TriangleMesh& mesh, const std::vector<HoleWitness>& witnesses,
                                     const HoleFillingOptions& options = {});

}  // namespace aligngs
