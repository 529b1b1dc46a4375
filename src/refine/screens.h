// Televisions and monitors: nothing on them can be matched, but their outlines can, and something supports them.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/screen_regions.h"
#include "refine/screen_support.h"

namespace aligngs {

struct ScreenSettings {
  /// `aligngs refine` and `run` switch it on; measured scenes (measured_scene.h) were not tried with it
  bool enabled = false;
  ScreenRegionSettings regions;
  SupportSettings support;
  /// |log| of the depth around today's that planes are tried at: networks are up to a third off
  double range = 0.45;
  int hypotheses = 121;       ///< planes tried there, odd: steps of 0.75 % of the depth
  double least_cosine = 0.2;  ///< between a plane's normal and the way to the camera
  /// degrees between the rays of two photos, below which one says nothing about the other's depth
  double least_angle = 2;
  double good_angle = 12;     ///< and from which it says as much as it can
  double least_inside = 0.6;  ///< of an outline that has to fall into another photo
  int least_photos = 2;       ///< other photos that see the outline
  /// intersection over union of a region and a rectangle, above which the photo shows that screen
  double same = 0.4;
  double behind = 0.02;           ///< of the depth: how far behind a wall nothing is
  double least_agreement = 0.35;  ///< of outlines on the plane; where no screen is it is 0.1 to 0.3
  double supported = 0.05;        ///< what standing on or hanging at something counts beside the agreement
  bool must_be_supported = true;  ///< a plane on which the screen has no support is none
  double margin = 0.1;            ///< by which a plane must beat where the screen is today
};

/// Finds for each screen (PanelClass::kScreen) the plane on which its outlines agree best in all photos of it. Tried
/// are planes around today's depth, parallel to a wall of `planes` or turned as the depth is, and none behind a wall. A
/// plane whose rectangle hangs at a wall, or rests on something level, has an advantage. It becomes a panel, in place
/// of the screen's former ones, if it beats the screen's current place by a margin. The current place is each photo's
/// own depth, or the panel of `panels` on which the screen lies. Otherwise nothing changes; so it does where too few
/// photos show the screen. `lumas`: the photos, one per view, of the labels' size. Deterministic for any number of
/// threads.
std::vector<Panel> place_screens(const std::vector<PlaneView>& views, const std::vector<const ImageF*>& lumas,
                                 const std::vector<PanelClass>& classes, const std::vector<ScenePlane>& planes,
                                 std::vector<Panel> panels, const ScreenSettings& settings, ThreadPool& pool);

}  // namespace aligngs
