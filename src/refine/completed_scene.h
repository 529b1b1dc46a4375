// Copies a scene with depth of a sensor, or given depth, and adds exposures and depth in its holes. Cameras and
// measured depth
// stay as they are.
#pragma once

#include <filesystem>
#include <vector>

#include "core/progress.h"
#include "refine/exposure.h"
#include "refine/hole_depth.h"
#include "scene/scene.h"

namespace aligngs {

struct CompleteSceneOptions {
  bool exposure = true;  ///< exposure.json is written where the photos differ
  ExposureSettings exposure_settings;
  double least_span = 0.03;  ///< largest less smallest log gain of a channel: a photo's own noise and gloss reach that
  bool holes = true;         ///< pred_depths/ and pred_confidence/ are written where stereo fills holes
  HoleDepthSettings hole_settings;
  double least_holes = 0.02;  ///< share of the pixels; smaller ones are left to training
  int largest_width = 1000;   ///< pixels; larger photos are measured at this width, and their maps have it
  bool overwrite = false;
  /// with overwrite: the output may be the scene itself, as where a run works on its own copy
  bool in_place = false;
  ProgressStyle progress;
};

struct CompleteSceneReport {
  std::vector<Vec3f> log_gains;  ///< of the training views, exposure.json
  double span = 0;               ///< largest less smallest log gain, of the channel where it is largest
  /// means over the training views of the shares of pixels without depth, and filled by stereo
  double holes = 0, filled = 0;
  double disagreement = 0;                  ///< median over the views of that of stereo and given depth, log units
  bool exposed = false, completed = false;  ///< what was written; neither: no scene was
};

/// Writes the new folder complete or not at all. Prior depth is in scene units. Error{kBadInput} when a training view
/// has none.
CompleteSceneReport complete_scene(Scene scene, const std::filesystem::path& output,
                                   const CompleteSceneOptions& options, ThreadPool& pool);

}  // namespace aligngs
