// Removal of what is no surface: specks, degenerate triangles, vertices that nothing uses.
#pragma once

#include <cstddef>

#include "scene/triangle_mesh.h"

namespace aligngs {

/// A connected component goes when any of its sizes is below the limit. Small true objects are larger; "keep the
/// largest only" would lose every wall that a doorway or an unseen strip separates from the rest.
struct ComponentLimits {
  double min_area = 0;    ///< squared scene units
  double min_extent = 0;  ///< scene units, diagonal of the bounding box
  size_t min_triangles = 0;
};

struct CleaningReport {
  size_t degenerate_triangles = 0;
  size_t components = 0;  ///< before
  size_t removed_components = 0;
  size_t removed_triangles = 0;  ///< in removed components
  size_t removed_vertices = 0;
};

/// Attributes follow; the order of what stays is kept. Triangles with a vertex out of range: Error{kBadInput}.
CleaningReport clean_mesh(TriangleMesh& mesh, const ComponentLimits& limits);

}  // namespace aligngs
