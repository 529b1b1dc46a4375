// The room layout where no photo shows it: walls, floor and ceiling go on behind furniture and beside the photos.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "refine/plane_depth.h"
#include "scene/point_cloud.h"

namespace aligngs {

/// One photo with what is known of it. `plane.depth` is that of the surface seen, 0 where there is none.
struct LayoutView {
  PlaneView plane;
  ImageF color;  ///< H x W x 3, sRGB
};

struct LayoutSettings {
  PlaneDepthSettings planes;  ///< how the planes of the layout are found
  double cell = 0.03;         ///< edge of the squares that planes are divided into, scene units
  double agreement = 0.03;    ///< a surface is on the plane within this share of its depth from the camera
  double beyond = 0.05;       ///< a photo sees through a plane when its surface lies this much (relative) farther
  /// A plane bounds the room when at most this share of all surfaces lies behind it (what windows show) and no camera
  /// does.
  /// Others, as a partition or the corner of an L, are not extended and do not limit the rest.
  double behind = 0.05;
  /// where no plane limits another, the surfaces' box does, less this share on each side
  double box_quantile = 0.002;
  int clear_cells = 3;     ///< squares left out around where photos see through the plane: doors, windows
  size_t least_seen = 50;  ///< squares of a plane that photos must show; else nothing says how it looks
};

/// Points of planes that no photo shows and none sees through, one per square.
struct UnseenLayout {
  PointCloud cloud;              ///< with normals into the room; colours spread from the seen parts of the same plane
  std::vector<uint16_t> labels;  ///< per point: the class that most of the plane's seen squares have
};

/// Closed-room prior: a room is closed by its walls, floor and ceiling, also where something hides them or no photo
/// looks. Nothing is claimed of planes that photos do not show at all. No labels, or nothing flat: empty. Needs neither
/// gravity nor right angles. Deterministic for any number of threads.
UnseenLayout unseen_layout(const std::vector<LayoutView>& views, const std::vector<PlaneClass>& classes,
                           const LayoutSettings& settings, ThreadPool& pool);

}  // namespace aligngs
