// Prior depth of panes, mirrors, screens and pictures brought to the plane of what can be measured of them.
#pragma once

#include <vector>

#include "refine/panels.h"
#include "refine/plane_depth.h"

namespace aligngs {

/// Possible places of a thing with that label.
enum class PanelClass : uint8_t {
  kNone,  ///< no panel
  /// panes and pictures: at most a little before a wall, so that the curtains that a teacher takes for the pane are
  /// none
  kInWall,
  kFree,  ///< mirrors: anywhere
  /// televisions and monitors: anywhere, and where no photo can match them their outlines tell the place (screens.h)
  kScreen,
};

struct PanelDepthSettings {
  PanelSettings panels;
  double least_certainty = 0.1;  ///< of the measured pixels that panels are found with
  int sampled_width = 640;       ///< pixels: of a larger photo as many are taken as if it had this width
  double before_wall = 0.02;     ///< of the depth: how far before a wall a picture hangs
  /// and how deep a pane lies in its niche: what is measured farther behind is seen through it
  double behind_wall = 0.1;
  int label_edge = 3;  ///< pixels from what is no panel: a teacher's outlines are wrong by so much
  /// |log(panel / depth)|: what networks see in a mirror or through a pane is up to twice as far
  double reach = 0.7;
  double strength = 3;  ///< weight of a pixel on a panel, where a sure stereo measurement weighs 1
  double off = 0.03;    ///< |log| from the panel within which a measured pixel is of it
  double sure = 0.3;    ///< certainty from which a pixel that is measured elsewhere keeps its depth
};

/// For each class of a label set, by name.
std::vector<PanelClass> panel_classes(const LabelSet& labels);

/// Panels, from the certain depth of the views' pixels of these classes. Views without depth, labels or certainty say
/// nothing.
std::vector<Panel> find_panels(const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                               const std::vector<ScenePlane>& planes, const PanelDepthSettings& settings);

/// Effect of panels on a pixel with such a label, instead of `measurements` (one per view); their `plane` becomes 0
/// there. `planes` are those that the panels were found with. A pixel belongs to the panel of the nearest measured
/// pixel of its region. If none is measured, it belongs to the first panel that its ray meets. A pixel that would be
/// behind the wall without a panel is in the wall (another pass of stereo then looks there). Deterministic for any
/// number of threads.
void measure_on_panels(const std::vector<Panel>& panels, const std::vector<ScenePlane>& planes,
                       const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                       const PanelDepthSettings& settings, ThreadPool& pool,
                       std::vector<PlaneMeasurement>& measurements);

}  // namespace aligngs
