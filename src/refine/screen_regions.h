// Screens by one photo's labels: each connected region, its outline and its current place.
#pragma once

#include <cstdint>
#include <vector>

#include "refine/outline.h"
#include "refine/panel_depth.h"

namespace aligngs {

struct ScreenRegionSettings {
  OutlineSettings outline;
  double least_pixels = 0.0015;  ///< of the photo's pixels: a smaller screen is not looked at
  size_t least_outline = 20;     ///< points
};

struct ScreenRegion {
  size_t view = 0;        ///< index of its photo
  Image<uint8_t> inside;  ///< H x W, 1 = of the region
  size_t pixels = 0;
  Vec2d centre;      ///< mean image point
  double depth = 0;  ///< median of its pixels today, > 0
  Vec3d normal;      ///< unit, world: of its depth today, to the camera
  std::vector<OutlinePoint> outline;
};

/// The connected regions of PanelClass::kScreen of a photo, in the order of their first pixels. Those that are small,
/// have few edges along their outline, or have no depth at half of their pixels are left out. `gradient` is that of the
/// photo's luma.
std::vector<ScreenRegion> screen_regions(const PlaneView& view, size_t index, const ImageF& gradient,
                                         const std::vector<PanelClass>& classes, const ScreenRegionSettings& settings);

}  // namespace aligngs
