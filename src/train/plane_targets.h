// Planes in the loop: walls, floor and ceiling (and tables) fitted to the current Gaussians. The depth and normal terms
// pull pixels whose rendered label names such a surface to them (ManhattanSDF, Guo et al. 2022, of any planes).
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/engine.h"
#include "engine/training_view.h"
#include "refine/plane_depth.h"
#include "train/training_set.h"

namespace aligngs {

/// Plane of each pixel of a training view, at the working resolution. Everything in the camera's frame of the time of
/// the fit.
struct ViewPlanes {
  std::vector<CameraPlane> planes;
  Image<uint8_t> plane;  ///< 1 + index into `planes`; 0: none
  /// 255 times the rendered probability of the label and how near the plane is, both in [0, 1]
  Image<uint8_t> weight;
  float depth_scale = 1;  ///< a_v of the view then (prior_alignment.h)
};

/// Result of the last fit, one entry per training view; empty before the first one.
struct PlaneTargets {
  std::vector<ViewPlanes> views;
  bool empty() const { return views.empty(); }
  double share() const;  ///< of all pixels that lie on a plane
};

struct PlaneFitRequest {
  const std::vector<GuideView>& views;
  const std::vector<PlaneClass>& classes;  ///< of the label set: which names are planes
  const std::vector<float>& depth_scales;
  RenderOptions render;  ///< near planes are those of the views
  bool square = false;   ///< planes of a room built square are turned to its axes
};

/// Planes of the rendered depth by the rendered labels: labels of all photos, which the Gaussians have fused. The same
/// for any number of threads. A model without semantics, or nothing flat: no planes, and no pixel on one.
PlaneTargets fit_plane_targets(const Engine& engine, const PlaneFitRequest& request, ThreadPool& pool);

/// Draws prior depth, its weight and prior normals of the views to the planes. The prior of a pixel has weight w, its
/// plane p = `strength` times the plane's weight. The logarithm of its depth and its normal are the means of both with
/// these weights. Its weight is min(1, w + p). For small errors L_z and the normal term then are the sum of both pulls.
/// Without a prior, the plane alone counts. Views may have another resolution than those of the fit. Without targets
/// nothing changes. Error{kFailed} when there are targets of another number of views.
void draw_to_planes(const PlaneTargets& targets, double strength, std::vector<TrainingView>& views);

}  // namespace aligngs
