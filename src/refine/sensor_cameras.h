// Cameras of a tracker, as those that come with a sensor's depth, checked against the photos and corrected where that
// helps.
#pragma once

#include <vector>

#include "refine/refine_cameras.h"

namespace aligngs {

struct SensorCameraSettings {
  /// Errors of a tracker and a sensor are smaller than those of networks, and their depth is not bent.
  SensorCameraSettings();
  RefineSettings refine;
  double least_residual = 0.002;  ///< of the image width: better cameras stay, as matches are hardly more exact
  double largest_left = 0.75;     ///< residual with corrected cameras / with the given ones, above which these stay
  /// A photo that moves farther than this times the median photo, by angle or distance, is not trusted.
  double largest_step = 4;
  int least_of_photo = 50;  ///< matches of a photo that agree with its corrected camera; with fewer it is not trusted
  /// A photo that is not trusted follows its nearest neighbour if that is so near, and otherwise keeps its camera. A
  /// tracker errs alike in neighbouring photos. Share of the extent, and degrees.
  double near_distance = 0.1, near_angle = 30;
  int least_matches = 200;  ///< of all photos; fewer tell nothing
};

struct SensorCameras {
  /// of all views, in their order: corrected, or as given
  std::vector<Camera> cameras;
  /// Median distance in pixels of matches from the places where depth and cameras put them: with the given cameras,
  /// and with corrected ones.
  double before = 0, after = 0;
  size_t matches = 0;
  int untrusted = 0;  ///< photos that follow a neighbour, or keep their camera
  bool corrected = false;
};

/// `views`: as for refine_cameras(), training photos with depth in scene units. With `correct` false nothing is
/// corrected and `after` is `before`. Deterministic for any number of threads.
SensorCameras check_sensor_cameras(const std::vector<RefineView>& views, double extent, bool correct,
                                   const SensorCameraSettings& settings, ThreadPool& pool,
                                   const RefineProgress& progress = {});

}  // namespace aligngs
