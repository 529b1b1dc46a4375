// Copies a scene with depth of a sensor, or given depth. Checks and corrects its cameras, cleans the sensor's depth,
// adds exposures, fills holes.
#pragma once

#include <filesystem>
#include <vector>

#include "core/progress.h"
#include "refine/exposure.h"
#include "refine/hole_depth.h"
#include "refine/sensor_cameras.h"
#include "refine/sensor_depth.h"
#include "scene/scene.h"

namespace aligngs {

struct CompleteSceneOptions {
  bool check_cameras = false;    ///< measure how well the cameras agree with the photos
  bool correct_cameras = false;  ///< and correct them where that helps (sensor_cameras.h), test photos included
  SensorCameraSettings camera_settings;
  bool exposure = true;  ///< exposure.json is written where the photos differ
  ExposureSettings exposure_settings;
  double least_span = 0.03;  ///< largest less smallest log gain of a channel: a photo's own noise and gloss reach that
  bool clean = false;        ///< depth of a sensor: mixed pixels are left out, doubtful ones have less confidence
  SensorDepthSettings clean_settings;
  double least_cleaned = 1e-3;  ///< share of the measured pixels that are mixed or doubtful; fewer are left alone
  bool holes = true;            ///< pred_depths/ and pred_confidence/ are written where stereo fills holes
  HoleDepthSettings hole_settings;
  double least_holes = 0.02;  ///< share of the pixels; smaller ones are left to training
  int largest_width = 1000;   ///< pixels; larger photos are measured at this width, and their maps have it
  bool overwrite = false;
  /// with overwrite: the output may be the scene itself, as where a run works on its own copy
  bool in_place = false;
  ProgressStyle progress;
};

struct CompleteSceneReport {
  SensorCameras cameras;         ///< of the training photos, then of the test photos where cameras were to be corrected
  std::vector<Vec3f> log_gains;  ///< of the training views, exposure.json
  double span = 0;               ///< largest less smallest log gain, of the channel where it is largest
  /// means over the training views of the shares of pixels without depth, and filled by stereo
  double holes = 0, filled = 0;
  double disagreement = 0;         ///< median over the views of that of stereo and given depth, log units
  double mixed = 0, doubtful = 0;  ///< means of SensorDepth's over the training views
  /// what was written; none: no scene was
  bool corrected = false, exposed = false, cleaned = false, completed = false;
};

/// Writes the new folder complete or not at all. Prior depth is in scene units. Error{kBadInput} when a training view
/// has none.
CompleteSceneReport complete_scene(Scene scene, const std::filesystem::path& output,
                                   const CompleteSceneOptions& options, ThreadPool& pool);

}  // namespace aligngs
