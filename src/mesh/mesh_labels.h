// Class labels of mesh vertices, voted by the views that see them.
#pragma once

#include <cstddef>
#include <vector>

#include "core/thread_pool.h"
#include "mesh/fusion_frame.h"

namespace aligngs {

struct MeshLabelingOptions {
  /// relative: how far a vertex may lie from the view's depth and still be what it sees
  double depth_tolerance = 0.02;
  double min_alpha = 0.5;  ///< pixels below say nothing
};

struct MeshLabelingReport {
  size_t labelled = 0;  ///< vertices with a label
  size_t unseen = 0;    ///< kNoLabel: no view sees them, or only pixels without label
};

/// Sets mesh.labels. Each view that sees a vertex (projects into its image, depth test passed) gives its pixel's label
/// as many votes as its probability. They are multiplied by the cosine between viewing direction and normal when the
/// mesh has normals. The class with most votes wins, the smaller of two equal ones.
MeshLabelingReport label_mesh(TriangleMesh& mesh, const std::vector<FusionFrame>& frames, ThreadPool& pool,
                              const MeshLabelingOptions& options = {});

}  // namespace aligngs
