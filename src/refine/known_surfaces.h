// Flat surfaces that labels have found before other planes are looked for: planes of the room, and panels.
#pragma once

#include <optional>
#include <vector>

#include "refine/panel_depth.h"
#include "refine/plane_depth.h"

namespace aligngs {

/// Surfaces that are flat by their labels.
struct FlatClasses {
  std::vector<PlaneClass> planes;  ///< per class (plane_classes())
  std::vector<PanelClass> panels;  ///< per class (panel_classes()); empty: panels are not looked for
};

/// The classes of a label set by name; without panels where those are not looked for.
FlatClasses flat_classes(const LabelSet& labels, PlaneSurfaces surfaces, bool with_panels);

/// Planes and panels of these classes.
struct FlatSurfaces {
  std::vector<ScenePlane> planes;
  std::optional<RoomAxes> axes;  ///< of a room that the planes show to be built square
  std::vector<Panel> panels;
};

struct FlatSettings {
  PlaneDepthSettings planes;
  PanelDepthSettings panels;
};

/// Planes of the room by their labels, and the pixels that lie on them, proud of them or on panels.
struct KnownSurfaces {
  std::vector<ScenePlane> planes;
  std::optional<RoomAxes> axes;  ///< of a room that these planes show to be built square
  /// one per view: where the weight is positive, the pixel lies there by its log factor; none: no pixel does
  std::vector<PlaneMeasurement> views;
};

/// Tells which pixels of `views` lie on a plane or a panel, with the depth that they have now; without either, none.
/// Deterministic for any number of threads.
KnownSurfaces known_surfaces(const std::vector<PlaneView>& views, const FlatSurfaces& found, const FlatClasses& classes,
                             const FlatSettings& settings, ThreadPool& pool);

}  // namespace aligngs
