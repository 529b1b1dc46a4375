// Multi-view geometric consistency: a pixel taken into a neighbouring view and back must come home (PGSR, Chen et al.
// 2024).
#pragma once

#include "engine/losses/map_losses.h"

namespace aligngs {

/// The forward-backward reprojection (formulas/two_views.h) of a view as a whole.
struct ViewAgreement {
  double count = 0;     ///< pixels that come home within kReprojectionMax
  double distance = 0;  ///< sum of w phi over them
};

/// Fills workspace.agreement (w = exp(-phi), 0 where the views do not see the same point) and .agreement_slope (w
/// dphi/dz).
/// Needs compute_depth_map and inputs.neighbour; a pixel takes part where its depth is kDepthTight.
/// Throws Error{kFailed} when the photo of the neighbour does not have the size of its camera.
template <class T>
ViewAgreement compare_with_neighbour(const MapLossInputs<T>& inputs, MapLossWorkspace<T>& workspace);

/// Mean of w phi over the pixels that agree, in pixels; w is a constant (detached), so nothing is gained by
/// disagreeing.
/// Zero with fewer than 1 % of the pixels. Adds weight * dL / dz to workspace.depth_gradient.
template <class T>
double multi_view_geometric_loss(const MapLossInputs<T>& inputs, double weight, const ViewAgreement& agreement,
                                 MapLossWorkspace<T>& workspace);

}  // namespace aligngs
