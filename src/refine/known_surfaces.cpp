#include "refine/known_surfaces.h"

namespace aligngs {

KnownSurfaces known_surfaces(const std::vector<PlaneView>& views, const FlatSurfaces& found, const FlatClasses& classes,
                             const FlatSettings& settings, ThreadPool& pool) {
  KnownSurfaces known{found.planes, found.axes, {}};
  if (found.planes.empty() && found.panels.empty()) return known;
  known.views = measure_on_planes(found.planes, views, classes.planes, settings.planes, pool);
  if (!classes.panels.empty())
    measure_on_panels(found.panels, found.planes, views, classes.panels, settings.panels, pool, known.views);
  return known;
}

}  // namespace aligngs
