// Support of a screen: a wall that it hangs at, or the top below it.
#pragma once

#include <vector>

#include "refine/panel_depth.h"

namespace aligngs {

/// Lengths are relative to the depth of the screen.
struct SupportSettings {
  double hangs_within = 0.05;  ///< of a parallel wall behind it: a flat screen with its holder is up to 15 cm deep
  double parallel = 12;        ///< degrees within which a wall is parallel
  double gap = 0.06;           ///< between a screen's lower edge and the top that carries its foot
  double overlap = 0.02;       ///< that the lower edge is found too low by
  double foot = 0.06;          ///< before and behind the screen's plane: what is level there carries it
  double level_cosine = 0.9;   ///< between the normal of a top and the vertical
  size_t least_points = 12;    ///< on a top
  int stride = 3;              ///< pixels between the points that tops are looked for with
};

class ScreenSupport {
 public:
  /// `classes` say which pixels are panels themselves, which carry none. Both lists have to outlive it.
  ScreenSupport(const std::vector<PlaneView>& views, const std::vector<PanelClass>& classes,
                const std::vector<ScenePlane>& planes, const SupportSettings& settings, ThreadPool& pool);

  /// A wall is parallel to the panel and near behind it.
  bool hangs(const Panel& panel) const;
  /// Something level lies under the panel's lower edge. False in a room without floor or ceiling, which say what is
  /// level.
  bool stands(const Panel& panel) const;

 private:
  const std::vector<ScenePlane>& planes_;
  SupportSettings settings_;
  std::vector<Vec3d> tops_;  ///< places on level surfaces that face up
};

}  // namespace aligngs
