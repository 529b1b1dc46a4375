#include "refine/known_surfaces.h"

namespace aligngs {

FlatClasses flat_classes(const LabelSet& labels, PlaneSurfaces surfaces, bool with_panels) {
  return {plane_classes(labels, surfaces), with_panels ? panel_classes(labels) : std::vector<PanelClass>()};
}

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
