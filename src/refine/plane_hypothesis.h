// Depth that a network misjudges by more than a plane reaches: other photos tell whether the plane is there.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "refine/guided_stereo.h"
#include "refine/plane_depth.h"

namespace aligngs {

struct PlaneHypothesisSettings {
  bool enabled = true;
  double reach = 0.4;  ///< |log(plane / depth)| beyond which the plane is no candidate
  /// correlation by which the photos must agree better where the plane is than where the depth is, on the mean of a
  /// window
  double gain = 0.1;
  /// the same for a floor or ceiling that is nearer than the depth: nothing lies behind them, so that the photos only must
  /// not contradict
  double gain_of_solid = -0.1;
  double least_score = 0.4;  ///< mean correlation where the plane is
  /// A plane with less than this share of another's points, turned by less than this angle (degrees), is doubtful. It may
  /// be a misjudged part of that other, and its pixels are tried there.
  double doubtful_share = 0.3, doubtful_angle = 15;
  int half_window = 8;       ///< pixels to each side over which agreement is averaged: single pixels are chance
  double least_known = 0.3;  ///< of a window's candidates that have texture; with less the photos say nothing
};

/// Tries the planes on pixels that are labelled as a part of them and lie beyond PlaneDepthSettings::reach, or on a
/// doubtful plane. Compares how well other photos agree with the plane and with the pixel's own depth. `measured` gets the plane where it wins.
/// `photos` and `views` are the same photos: `views` have depth as stereo corrected it. The same for any number of
/// threads. Pixels on a plane already, without a label, and of glass stay as they are.
void try_planes(const std::vector<MatchView>& photos, const std::vector<PlaneView>& views,
                const std::vector<PlaneClass>& classes, const std::vector<ScenePlane>& planes,
                const PlaneDepthSettings& plane_settings, const StereoSettings& stereo,
                const PlaneHypothesisSettings& settings, ThreadPool& pool, std::vector<PlaneMeasurement>& measured);

}  // namespace aligngs
