// Measured depth where stereo is blind and labels are not: bare walls, floors and ceilings lie on the planes of what
// was measured of them.
#pragma once

#include "refine/known_surfaces.h"
#include "refine/panel_depth.h"
#include "refine/photo_depth.h"
#include "refine/plane_depth.h"
#include "refine/screens.h"

namespace aligngs {

/// Settings for pixels that no other photo confirms. Their depth lies between measurements that may be far away, and
/// nothing follows from its slope.
inline PlaneDepthSettings loose_planes() {
  PlaneDepthSettings settings;
  settings.reach = 0.35;
  settings.normal_angle = 180;
  return settings;
}

struct LabelledDepthSettings {
  /// finds the planes, from confirmed pixels alone; and what lies on them of those
  PlaneDepthSettings sure;
  PlaneDepthSettings unsure = loose_planes();  ///< what lies on them of the others
  PanelDepthSettings panels;                   ///< panes, mirrors, screens and pictures, by what is confirmed of them
  ScreenSettings screens;                      ///< and screens by their edges
  LogCorrectionSettings spread;                ///< of the depth between
  double certainty = 0.5;                      ///< of a pixel on a plane that was not measured itself
};

struct LabelledDepthReport {
  std::vector<ScenePlane> planes;
  std::vector<Panel> panels;
  std::optional<RoomAxes> axes;  ///< of a room that its planes show to be built square
  double on_planes = 0;          ///< share of the pixels that lie on one of either
};

/// The planes and panels of `report`, and the pixels that lie on them with the depth that they have now.
KnownSurfaces known_surfaces(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                             const std::vector<PhotoDepth>& depths, const LabelledDepthReport& report,
                             const FlatClasses& classes, const LabelledDepthSettings& settings, ThreadPool& pool);

/// Changes depth and certainty of `depths` (one per view; photo_depth()'s). `labels`: H x W classes of each photo,
/// kNoLabel = none.
/// Without flat surfaces nothing changes. Deterministic for any number of threads.
LabelledDepthReport lay_on_planes(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                                  const FlatClasses& classes, const LabelledDepthSettings& settings, ThreadPool& pool,
                                  std::vector<PhotoDepth>& depths);

}  // namespace aligngs
