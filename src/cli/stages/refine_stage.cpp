#include "cli/stages/refine_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/log.h"
#include "io/file_system_error.h"
#include "refine/camera_report.h"
#include "refine/completed_scene.h"
#include "refine/measured_scene.h"
#include "refine/refined_scene.h"
#include "scene/ignored_classes.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Common part of measuring and refining a scene.
template <class Options>
Options options_of(const TrainConfig& config, const CommandContext& context) {
  Options options;
  options.overwrite = options.in_place = true;  // RUN/scene may be what is read
  options.exposure = config.data.refine_exposure;
  options.planes = config.data.refine_planes && config.data.semantics;
  options.panels = config.data.refine_panels;
  if (config.data.refine_tables) options.surfaces = PlaneSurfaces::kLayoutAndTables;
  options.progress = context.progress();
  return options;
}

/// The scene without what the run ignores.
Scene trained_part(Scene scene, const TrainConfig& config) {
  scene.ignored = ignored_classes(scene.labels, config.data.ignore);
  return scene;
}

/// How well cameras that came with a sensor's depth agree with the photos, and what was done about it.
std::string describe_check(const SensorCameras& check, bool asked) {
  if (check.matches == 0)
    return "the photos share no corner with depth, so that nothing tells how exact the cameras are";
  const std::string found =
      fmt::format("{} matches of the photos lie {:.2f} px (median) from where cameras and depth put them",
                  check.matches, check.before);
  if (check.corrected) return fmt::format("{}; corrected to {:.2f} px", found, check.after);
  if (check.after < check.before)
    return fmt::format("{}; corrected ones would leave {:.2f} px, so they stay", found, check.after);
  return found + (asked ? "; they stay as they are" : "; data.sensor_cameras=true corrects them where that helps");
}

void log_bare_planes(const BarePlaneReport& report) {
  if (report.planes.empty()) return;
  log_info("{} planes of whatever was measured; {:.0f} % of the pixels lie on one", report.planes.size(),
           100 * report.on_planes);
}

}  // namespace

bool measure_into_run(const Scene& scene, const fs::path& run, const TrainConfig& config,
                      const CommandContext& context) {
  auto options = options_of<MeasureSceneOptions>(config, context);
  options.bare_planes = config.data.bare_planes;
  options.plane_settings.sure.square = config.data.refine_square;
  ThreadPool pool(context.global.threads);
  make_folders(run);
  const MeasureSceneReport report = measure_scene(trained_part(scene, config), run / "scene", options, pool);
  if (report.views == 0) {
    log_warning("{}; training starts from the points", kNothingMeasured);
    return false;
  }
  log_info("depth measured in {} photos: {:.0f} % of the pixels are confirmed by another photo", report.views,
           100 * report.measured);
  log_bare_planes(report.bare);
  return true;
}

CompletedScene complete_into_run(const Scene& scene, const fs::path& run, const TrainConfig& config,
                                 const CommandContext& context) {
  CompleteSceneOptions options;
  options.check_cameras = is_sensor_depth(scene.prior_source);
  options.correct_cameras = options.check_cameras && config.data.sensor_cameras;
  options.overwrite = options.in_place = true;  // RUN/scene may be what is read
  options.exposure = config.data.exposure && config.data.sensor_exposure;
  options.clean = config.data.clean_depth;
  options.holes = config.data.fill_depth;
  options.progress = context.progress();
  ThreadPool pool(context.global.threads);
  make_folders(run);
  const CompleteSceneReport report = complete_scene(trained_part(scene, config), run / "scene", options, pool);
  CompletedScene completed{report.corrected || report.exposed || report.cleaned || report.completed,
                           options.check_cameras ? describe_check(report.cameras, options.correct_cameras) : ""};
  if (!completed.camera_note.empty()) log_info("cameras: {}", completed.camera_note);
  if (options.exposure) {
    log_info(
        "exposures: the brightest photo has {:.2f} times the light of the darkest, in the channel that differs most{}",
        std::exp(report.span), report.exposed ? "" : "; photos are used as they are");
  }
  if (report.cleaned) {
    log_info("depth of the sensor: {:.1f} % of its pixels mix two surfaces and are left out, {:.0f} % are doubtful",
             100 * report.mixed, 100 * report.doubtful);
  }
  if (report.completed) {
    log_info(
        "holes of the depth: {:.0f} % of the pixels have none, stereo fills {:.0f} %; where both measured they differ "
        "by {:.1f} %",
        100 * report.holes, 100 * report.filled, 100 * report.disagreement);
  }
  return completed;
}

void refine_into_run(const Scene& scene, const fs::path& run, const TrainConfig& config,
                     const CommandContext& context) {
  auto options = options_of<RefineSceneOptions>(config, context);
  options.stereo = config.data.refine_stereo;
  options.fuse_labels = config.data.refine_fused_labels;
  options.screen_settings.enabled = config.data.refine_screens;
  options.bare_planes = config.data.bare_planes;
  options.plane_settings.square = config.data.refine_square;
  ThreadPool pool(context.global.threads);
  make_folders(run);
  const RefineSceneReport report = refine_scene(trained_part(scene, config), run / "scene", options, pool);
  log_info("prior depth: {}", report.depth_placement);
  const RefineResult& result = report.cameras;
  if (result.tracks == 0)
    log_warning("{}", camera_report(result));
  else
    log_info("{}", camera_report(result));
  const auto misplaced =
      std::count_if(result.views.begin(), result.views.end(), [](const RefinedView& v) { return v.misplaced; });
  if (misplaced > 0) log_info("{} misplaced photos were found at other places, by the points of the others", misplaced);
  if (!report.planes.empty()) {
    log_info("{} planes; {:.0f} % of the pixels lie on one", report.planes.size(), 100 * report.on_planes);
  }
  log_bare_planes(report.bare);
  if (!report.panels.empty())
    log_info("{} panes, mirrors, screens or pictures have planes of their own", report.panels.size());
}

}  // namespace aligngs
