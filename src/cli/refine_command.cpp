// `aligngs refine SCENE`: cameras and prior depth corrected from matches between the photos.
#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "refine/camera_report.h"
#include "refine/measured_scene.h"
#include "refine/refined_scene.h"

namespace aligngs {
namespace {

struct RefineCommandOptions {
  std::string scene, output;
  bool keep_depth = false, no_stereo = false, no_planes = false, no_bare_planes = false, tables = false,
       fuse_labels = false, no_square = false, no_plane_trials = false, no_panels = false, no_screens = false;
  bool no_exposure = false;
  bool keep_tests = false, own_focal = false, overwrite = false;
  int passes = RefineSceneOptions{}.passes;
};

PlaneSurfaces surfaces_of(const RefineCommandOptions& options) {
  return options.tables ? PlaneSurfaces::kLayoutAndTables : PlaneSurfaces::kLayout;
}

/// Largest difference of the photos' log gains of green; 0 without any.
double exposure_span(const std::vector<Vec3f>& log_gains) {
  if (log_gains.empty()) return 0;
  const auto less = [](const Vec3f& a, const Vec3f& b) { return a.y < b.y; };
  const auto [darkest, brightest] = std::minmax_element(log_gains.begin(), log_gains.end(), less);
  return static_cast<double>(brightest->y - darkest->y);
}

void print_planes(const std::vector<ScenePlane>& planes, double share, const std::optional<RoomAxes>& axes) {
  if (!planes.empty()) std::printf("%zu planes; %.0f %% of the pixels lie on one\n", planes.size(), 100 * share);
  if (axes) std::printf("the room has right angles: %.0f %% of its planes face along three axes\n", 100 * axes->share);
  if (axes && axes->up) std::printf("up is (%.3f, %.3f, %.3f)\n", axes->up->x, axes->up->y, axes->up->z);
}

void print_bare_planes(const BarePlaneReport& report) {
  if (report.planes.empty()) return;
  std::printf("%zu planes of whatever was measured; %.0f %% of the pixels lie on one\n", report.planes.size(),
              100 * report.on_planes);
}

void print_panels(size_t count) {
  if (count > 0) std::printf("%zu panes, mirrors, screens or pictures have planes of their own\n", count);
}

/// World direction; null where the planes do not say.
nlohmann::ordered_json up_json(const std::optional<RoomAxes>& axes) {
  if (!axes || !axes->up) return nullptr;
  return {axes->up->x, axes->up->y, axes->up->z};
}

void print_exposure(const std::vector<Vec3f>& log_gains) {
  if (!log_gains.empty())
    std::printf("photos differ in exposure by up to %.0f %%\n", 100 * std::expm1(exposure_span(log_gains)));
}

void measure(const CommandContext& context, const RefineCommandOptions& options, const Scene& scene) {
  MeasureSceneOptions measure_options;
  measure_options.exposure = !options.no_exposure;
  measure_options.planes = !options.no_planes;
  measure_options.bare_planes = !options.no_planes && !options.no_bare_planes;
  measure_options.surfaces = surfaces_of(options);
  measure_options.plane_settings.sure.square = !options.no_square;
  measure_options.panels = !options.no_panels;
  measure_options.overwrite = options.overwrite;
  measure_options.progress = context.progress();
  ThreadPool pool(context.global.threads);
  const MeasureSceneReport report = measure_scene(scene, options.output, measure_options, pool);
  if (report.views == 0) {
    throw_bad_input(scene.folder, "images", kNothingMeasured,
                    "add photos, or train from the points alone (`aligngs run` does)");
  }
  if (context.global.json) {
    const nlohmann::ordered_json document = {{"scene", options.output},
                                             {"views", report.views},
                                             {"depth_measured", report.measured},
                                             {"planes", report.planes.planes.size()},
                                             {"on_planes", report.planes.on_planes},
                                             {"bare_planes", report.bare.planes.size()},
                                             {"on_bare_planes", report.bare.on_planes},
                                             {"square", report.planes.axes.has_value()},
                                             {"up", up_json(report.planes.axes)},
                                             {"panels", report.planes.panels.size()},
                                             {"exposure_span", exposure_span(report.log_gains)}};
    print_json(document);
    return;
  }
  std::printf(
      "depth measured in %zu photos: %.0f %% of the pixels are confirmed by another photo, the rest lies between "
      "them\n",
      report.views, 100 * report.measured);
  print_planes(report.planes.planes, report.planes.on_planes, report.planes.axes);
  print_bare_planes(report.bare);
  print_panels(report.planes.panels.size());
  print_exposure(report.log_gains);
}

void refine(const CommandContext& context, const RefineCommandOptions& options) {
  const Scene scene = open_scene(options.scene);
  if (!scene.has_prior_depth()) return measure(context, options, scene);
  RefineSceneOptions refine_options;
  refine_options.correct_depth = !options.keep_depth;
  refine_options.stereo = !options.no_stereo;
  refine_options.planes = !options.no_planes;
  refine_options.surfaces = surfaces_of(options);
  refine_options.fuse_labels = options.fuse_labels;
  refine_options.bare_planes = !options.no_planes && !options.no_bare_planes;
  refine_options.plane_settings.square = !options.no_square;
  refine_options.hypothesis_settings.enabled = !options.no_plane_trials;
  refine_options.panels = !options.no_panels;
  refine_options.screen_settings.enabled = !options.no_screens;
  refine_options.exposure = !options.no_exposure;
  refine_options.register_tests = !options.keep_tests;
  refine_options.settings.share_focal = !options.own_focal;
  refine_options.overwrite = options.overwrite;
  refine_options.passes = options.passes;
  refine_options.progress = context.progress();
  ThreadPool pool(context.global.threads);
  const RefineSceneReport report = refine_scene(scene, options.output, refine_options, pool);
  const RefineResult& result = report.cameras;
  if (context.global.json) {
    nlohmann::ordered_json views = nlohmann::ordered_json::array();
    for (size_t i = 0; i < result.views.size(); ++i) {
      const RefinedView& v = result.views[i];
      views.push_back({{"name", report.names[i]},
                       {"observations", v.observations},
                       {"turned_degrees", v.turned},
                       {"shifted", v.shifted},
                       {"by_neighbour", v.by_neighbour},
                       {"misplaced", v.misplaced}});
    }
    const nlohmann::ordered_json document = {{"scene", options.output},
                                             {"tracks", result.tracks},
                                             {"reprojection_median_before_px", result.bundle.start_median},
                                             {"reprojection_median_px", result.bundle.end_median},
                                             {"focal_factor", result.focal_factor},
                                             {"depth_measured", report.measured},
                                             {"planes", report.planes.size()},
                                             {"on_planes", report.on_planes},
                                             {"bare_planes", report.bare.planes.size()},
                                             {"on_bare_planes", report.bare.on_planes},
                                             {"square", report.axes.has_value()},
                                             {"up", up_json(report.axes)},
                                             {"panels", report.panels.size()},
                                             {"exposure_span", exposure_span(report.log_gains)},
                                             {"views", views}};
    print_json(document);
    return;
  }
  std::printf("%s\n", camera_report(result).c_str());
  if (report.measured > 0)
    std::printf("stereo measured the depth of %.0f %% of the pixels; the rest follows the measurements around it\n",
                100 * report.measured);
  print_planes(report.planes, report.on_planes, report.axes);
  print_bare_planes(report.bare);
  print_panels(report.panels.size());
  print_exposure(report.log_gains);
  for (size_t i = 0; i < result.views.size(); ++i) {
    const RefinedView& v = result.views[i];
    const char* remark = v.by_neighbour ? "  (too few: follows its nearest neighbour)"
                         : v.misplaced  ? "  (was misplaced)"
                                        : "";
    std::printf("%-24s %5d observations  turned %.2f deg  moved %.4f%s\n", report.names[i].c_str(), v.observations,
                v.turned, v.shifted, remark);
  }
}

}  // namespace

void add_refine_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand(
      "refine", "Correct cameras and depth from the photos themselves, or measure missing depth");
  command->group("Data");
  command->footer(
      help_footer({.reads = "a scene folder",
                   .writes = "REFINED: a copy of the scene with corrected cameras and depth",
                   .example = "aligngs refine scene -o refined",
                   .advanced = "aligngs refine scene -o refined --passes 3 --no-planes --own-focal",
                   .notes = "`aligngs run` and `aligngs demo` do this by default.\n"
                            "Without prior depth, cameras stay, and stereo measures depth between the scene's points.\n"
                            "Test photos are registered afterwards and move nothing."}));
  auto options = std::make_shared<RefineCommandOptions>();
  command->add_option("scene", options->scene, "scene folder")->required();
  command->add_option("-o,--output", options->output, "scene folder to write")->required()->group("Output folder");
  command->add_flag("--keep-depth", options->keep_depth, "leave pred_depths/ as they are")->group("Depth");
  command
      ->add_flag("--no-stereo", options->no_stereo,
                 "correct depth by a smooth factor per photo, without multi-view stereo")
      ->group("Depth");
  command->add_flag("--no-planes", options->no_planes, "leave the depth of walls, floor and ceiling off their planes")
      ->group("Planes");
  command
      ->add_flag("--no-bare-planes", options->no_bare_planes, "keep bare surfaces off the planes of what was measured")
      ->group("Planes");
  command->add_flag("--plane-tables", options->tables, "put the tops of tables, desks and counters on planes, too")
      ->group("Planes");
  command
      ->add_flag("--fuse-labels", options->fuse_labels,
                 "find planes by the labels of most photos, and weigh each pixel by their share")
      ->group("Planes");
  command->add_flag("--no-square", options->no_square, "keep planes as found, also in a room with right angles")
      ->group("Planes");
  command
      ->add_flag("--no-plane-trials", options->no_plane_trials,
                 "do not ask other photos whether a wall or floor is where its plane is, far from its depth")
      ->group("Planes");
  command
      ->add_flag("--no-screens", options->no_screens,
                 "do not place televisions and monitors by their outlines in several photos")
      ->group("Planes");
  command
      ->add_flag("--no-panels", options->no_panels, "give panes, mirrors, screens and pictures no planes of their own")
      ->group("Planes");
  command->add_flag("--no-exposure", options->no_exposure, "leave exposure and white balance unmeasured")
      ->group("Depth");
  command->add_flag("--keep-test-views", options->keep_tests, "leave the test photos unregistered")->group("Cameras");
  command->add_flag("--own-focal", options->own_focal, "give every photo a focal length of its own")->group("Cameras");
  command->add_option("--passes", options->passes, "number of passes; better depth finds more matches")
      ->check(CLI::Range(1, 5))
      ->capture_default_str()
      ->group("Depth");
  command->add_flag("--overwrite", options->overwrite, "replace a scene that aligngs wrote")->group("Output folder");
  command->callback([&context, options] { refine(context, *options); });
}

}  // namespace aligngs
