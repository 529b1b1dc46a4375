// Normals beside label edges, supervised from one side each: ours in place of L_nb.
#pragma once

#include "engine/formulas/label_edges.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// Judges by the angle between the two prior normals and by the depth jump at the edge. The jump lies between the
/// points where the two prior planes (point, normal) meet the edge's ray. A slanted but unbroken surface has no jump.
EdgeKind classify_edge(const Vec3d& normal_before, const Vec3d& point_before, const Vec3d& normal_after,
                       const Vec3d& point_after, const Vec3d& edge_ray);

/// The prior on both sides of one label edge.
struct EdgePrior {
  EdgeKind kind = EdgeKind::kNothing;
  double weight = 0;    ///< the smaller view.depth_weight of the two prior pixels
  Vec3d before, after;  ///< prior normals
};

/// kNothing where a label changes again within 4 px, or the prior is silent. The view must have labels, prior depth and
/// prior normals.
EdgePrior prior_at_edge(const TrainingView& view, const LabelPair& pair);

/// Takes each pair of right and down neighbours with different teacher labels and unchanged labels out to 4 px on
/// either side. Crease: (1 - n . n_prior) 2 px to each side, n_prior that of 4 px on the same side. Coplanar: 1 - n .
/// n' across the edge; otherwise nothing. Terms are weighted by the smaller view.depth_weight of the two prior pixels.
/// Their sum is divided by the larger of the sum of weights and 1 % of the pixels. A single edge pixel hence never
/// carries the whole term. Zero without labels, prior depth or prior normals. Needs compute_unit_normals.
template <class T>
double crease_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                   MapGradients<T>& gradients);

}  // namespace aligngs
