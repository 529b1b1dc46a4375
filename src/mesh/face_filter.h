// Bilateral filtering of face normals: the noise of a surface goes, its edges stay.
#pragma once

#include "core/thread_pool.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct FaceFilterOptions {
  int rounds = 0;  ///< of the filter over the normals; 0 leaves the mesh as it is
  /// Length of the difference of two unit normals at which a neighbour counts for 0.61: 14 degrees. The noise of a fused
  /// room is below, the corners of furniture are far above.
  double normal_sigma = 0.25;
  /// Multiple of the mean distance between centres of neighbouring faces at which a neighbour counts for 0.61.
  double distance_sigma = 1;
  int vertex_rounds = 10;  ///< in which the vertices follow the filtered normals
  double max_shift = 0;    ///< scene units: a vertex moves by at most this; 0: no limit
};

/// Moves the vertices so that the faces follow filtered normals (Zheng, Fu, Au and Tai 2011, local iterative scheme):
///
///   n_i <- normalised sum over i and its neighbours j of
///          area_j exp(-|c_i - c_j|^2 / 2 sigma_c^2) exp(-|n_i - n_j|^2 / 2 sigma_n^2) n_j
///   v   <- v + mean over the faces k at v of n_k (n_k . (c_k - v))     (Sun, Rosin, Martin and Langbein 2007)
///
/// with centres c of the faces. Neighbours share an edge that no third face has. A face without area has no
/// normal and moves nothing. Vertex normals, where the mesh has them, become the mean of the filtered face normals,
/// weighted by area. Number and order of vertices and triangles stay. The result is the same for any number of threads.
/// Error{kUsage} for a negative number of rounds, or a sigma that is not positive.
void filter_faces(TriangleMesh& mesh, const FaceFilterOptions& options, ThreadPool& pool);

}  // namespace aligngs
