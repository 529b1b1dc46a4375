// A scene folder with refined cameras: everything else of the scene, its truth included, is taken over as it is.
#pragma once

#include <filesystem>
#include <string>

#include "core/progress.h"
#include "refine/bare_plane_factors.h"
#include "refine/exposure.h"
#include "refine/guided_stereo.h"
#include "refine/panel_depth.h"
#include "refine/plane_depth.h"
#include "refine/plane_hypothesis.h"
#include "refine/refine_cameras.h"
#include "refine/screens.h"
#include "scene/scene.h"

namespace aligngs {

struct RefineSceneOptions {
  RefineSettings settings;
  StereoSettings stereo_settings;
  bool correct_depth = true;  ///< pred_depths/ of the training views are multiplied by their DepthGrid
  bool stereo = true;         ///< and then by what multi-view stereo finds with the refined cameras
  PlaneDepthSettings plane_settings;
  PlaneHypothesisSettings hypothesis_settings;
  bool planes = true;  ///< and moved to the planes of walls, floor and ceiling, if the scene has labels
  PlaneSurfaces surfaces = PlaneSurfaces::kLayout;
  /// planes are found by the labels of most photos, and draw by their share (refine/fused_labels.h)
  bool fuse_labels = false;
  PanelDepthSettings panel_settings;
  /// where planes are looked for: panes, mirrors, screens and pictures get planes of their own
  bool panels = true;
  /// at the end, bare surfaces are laid on planes of what was measured, whatever it is; only where photos have labels
  bool bare_planes = true;
  BarePlaneSettings bare_settings = bare_planes_of_network();
  ScreenSettings screen_settings;  ///< of those of screens, which edges in several photos tell
  /// Times that all of it is done: with depth that stereo and planes have corrected, more and better matches are found.
  int passes = 2;
  ExposureSettings exposure_settings;
  /// exposure.json is written: how the training photos differ in exposure and white balance
  bool exposure = true;
  bool register_tests = true;  ///< false: test views keep their cameras relative to the nearest training view
  bool overwrite = false;
  bool in_place = false;  ///< with overwrite: the output may be the scene itself, as where a run works on its own copy
  ProgressStyle progress;
};

struct RefineSceneReport {
  RefineResult cameras;
  std::vector<std::string> names;  ///< of the photos of cameras.views, in their order
  std::string depth_placement;     ///< describe() of the prior depth as it was read (scene/depth_placement.h)
  /// mean over training views of the share of pixels whose depth stereo measured; 0 without stereo
  double measured = 0;
  std::vector<ScenePlane> planes;
  std::vector<Panel> panels;
  std::optional<RoomAxes> axes;  ///< of a room that its planes show to be built square
  double on_planes = 0;          ///< share of the pixels with depth that lie on one of them
  BarePlaneReport bare;          ///< planes of whatever was measured
  std::vector<Vec3f> log_gains;  ///< of the training views, exposure.json; empty without
};

/// Reads the scene, refines, writes the new folder complete or not at all. Views whose files are damaged are left out
/// with a warning (usable_views.h). Needs prior depth of all training views, in scene units or in units that can be
/// scaled to them. Error{kBadInput} otherwise: prior depth says where to look for a match. The corrected depth is in
/// scene units. The points of the scene stay unchanged: training scales each photo's depth to them
/// (docs/decisions/0001-surface.md has what that does).
RefineSceneReport refine_scene(Scene scene, const std::filesystem::path& output, const RefineSceneOptions& options,
                               ThreadPool& pool);

/// scene.json says that refine_scene() made this scene.
bool is_refined_scene(const std::filesystem::path& folder);

}  // namespace aligngs
