// Normals beside label edges, supervised from one side each (guidance 2.3): what replaces L_nb by default.
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

inline constexpr double kCreaseAngleDegrees = 25;    ///< prior normals that differ by more fold the surface here
inline constexpr double kCreaseJumpShare = 0.03;     ///< and the surface is unbroken: |dz| / z below this
inline constexpr double kCoplanarAngleDegrees = 10;  ///< prior normals that differ by less lie in one plane
inline constexpr double kCoplanarJumpShare = 0.01;   ///< when also |dz| / z is below this
inline constexpr int kCreasePriorOffset = 4;         ///< pixels from the edge at which prior normals are read
inline constexpr int kCreaseRenderOffset = 2;        ///< pixels from the edge at which rendered normals are compared
inline constexpr double kCreaseMinimumShare = 0.01;  ///< the sum is divided by at least this share of the pixels

/// What the prior says about the surface at a label edge.
enum class EdgeKind { kNothing, kCrease, kCoplanar };

/// Judges by the angle between the two prior normals and by the depth jump at the edge, which is where the two
/// prior planes (point, normal) meet the edge's ray: a slanted but unbroken surface has no jump.
EdgeKind classify_edge(const Vec3d& normal_before, const Vec3d& point_before, const Vec3d& normal_after,
                       const Vec3d& point_after, const Vec3d& edge_ray);

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
