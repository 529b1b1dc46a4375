// Normals beside label edges, supervised from one side each: ours in place of L_nb.
#pragma once

#include "engine/formulas/label_edges.h"
#include "engine/losses/map_losses.h"

namespace aligngs {

/// Judges by the angle between the two prior normals and by the depth jump at the edge, which is where the two
/// prior planes (point, normal) meet the edge's ray: a slanted but unbroken surface has no jump.
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

/// For each pair of right and down neighbours with different teacher labels and unchanged labels out to 4 px on
/// either side: crease: (1 - n . n_prior) 2 px to each side, n_prior that of 4 px on the same side; coplanar:
/// 1 - n . n' across the edge; otherwise nothing. Terms are weighted by the smaller view.depth_weight of the
/// two prior pixels; their sum is divided by the sum of weights, or by 1 % of the pixels if that is more, so that
/// a single edge pixel never carries the whole term. Zero without labels, prior depth or prior normals.
/// Needs compute_unit_normals.
template <class T>
double crease_loss(const MapLossInputs<T>& inputs, double weight, MapLossWorkspace<T>& workspace,
                   MapGradients<T>& gradients);

}  // namespace aligngs
