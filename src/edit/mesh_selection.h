// The part of a mesh that belongs to selected Gaussians.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct MeshSelectionOptions {
  double sigmas = 3;  ///< reach of a Gaussian
  double thickness =
      0.004;  ///< / extent: least standard deviation across the disc, as fusion moves the surface (1.3 cm)
  int smoothing_rounds = 3;  ///< majority over adjacent vertices
};

/// Each Gaussian votes for the vertices near it with opacity * exp(-m^2 / 2), m the Mahalanobis distance. A vertex is
/// selected when the selected Gaussians have more votes than the others. Returns one flag per vertex.
std::vector<uint8_t> select_vertices(const TriangleMesh& mesh, const GaussianModel& model,
                                     const std::vector<uint8_t>& selected, double extent, ThreadPool& pool,
                                     const MeshSelectionOptions& options = {});

/// Rows of the whole mesh that a part was made of.
struct SubmeshRows {
  std::vector<uint32_t> vertices, triangles;
};

/// The triangles of which at least two vertices have the flag `value`, with the vertices they use, both in their order;
/// attributes follow.
TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<uint8_t>& flags, uint8_t value,
                     SubmeshRows* rows = nullptr);

/// The given triangles, with the vertices that they use.
TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles, SubmeshRows* rows = nullptr);

}  // namespace aligngs
