// A scene folder with depth measured in its photos, for scenes with cameras and points and no prior depth.
#pragma once

#include <filesystem>

#include "core/progress.h"
#include "refine/bare_planes.h"
#include "refine/exposure.h"
#include "refine/labelled_depth.h"
#include "refine/photo_depth.h"
#include "scene/scene.h"

namespace aligngs {

struct MeasureSceneOptions {
  /// pixels; larger photos are measured at this width, and their maps have it: a pixel takes 500 bytes per thread
  int largest_width = 1000;
  PhotoDepthSettings settings;
  LabelledDepthSettings plane_settings;
  bool planes = true;  ///< what is labelled wall, floor or ceiling is laid on planes, where the scene has labels
  PlaneSurfaces surfaces = PlaneSurfaces::kLayout;
  bool bare_planes = true;  ///< bare surfaces are laid on planes of what was measured
  BarePlaneSettings bare_settings;
  bool panels = true;  ///< and panes, mirrors, screens and pictures on planes of their own
  ExposureSettings exposure_settings;
  bool exposure = true;  ///< exposure.json is written: how the training photos differ in exposure and white balance
  bool overwrite = false;
  bool in_place = false;  ///< with overwrite: the output may be the scene itself, as where a run works on its own copy
  ProgressStyle progress;
};

/// Message for a report of no views.
inline constexpr const char* kNothingMeasured =
    "no depth can be measured: no two photos show the same from places far enough apart";

struct MeasureSceneReport {
  double measured = 0;  ///< mean over the training views of the share of pixels whose depth another photo confirms
  size_t views = 0;     ///< training views whose depth could be measured; 0: nothing was written
  LabelledDepthReport planes;    ///< nothing in it without labels
  BarePlaneReport bare;          ///< planes of whatever was measured
  std::vector<Vec3f> log_gains;  ///< of the training views; empty without
};

/// Reads the scene, measures, writes the new folder complete or not at all. Views whose files are damaged are left out
/// with a warning (usable_views.h). Cameras and points stay as they are; test photos are not read. pred_depths/ holds
/// depth where it is certain, or between such places. Photos that share nothing with others have none. pred_confidence/
/// holds the certainty. Error{kBadInput} for a scene without points.
MeasureSceneReport measure_scene(Scene scene, const std::filesystem::path& output, const MeasureSceneOptions& options,
                                 ThreadPool& pool);

}  // namespace aligngs
