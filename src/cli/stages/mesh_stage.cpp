#include "cli/stages/mesh_stage.h"

#include <algorithm>

#include "cli/stages/pictured_views.h"
#include "cli/stages/surface_pictures.h"
#include "core/error.h"
#include "core/is_depth.h"
#include "core/log.h"
#include "mesh/surface_depth.h"
#include "refine/refined_scene.h"
#include "scene/depth_placement.h"
#include "scene/measured_hull.h"
#include "scene/mesh_ply.h"
#include "scene/view_data.h"
#include "train/far_shell.h"
#include "train/rendered_view.h"
#include "train/training_set.h"

namespace aligngs {
namespace {

// of a depth on a plane of the room, or of the prior, beside a rendered one, when surfaces are smoothed
constexpr float kSureCertainty = 100;

FusionOptions fusion_options(const LoadedRun& run) {
  const MeshConfig& mesh = run.config().mesh;
  FusionOptions options;
  options.metric = run.scene().metric;
  options.extent = robust_extent(run.scene());
  options.voxel = mesh.voxel;
  options.truncation = mesh.truncation;
  options.max_depth = mesh.max_depth;
  options.min_alpha = mesh.alpha_min;
  options.min_cosine = mesh.min_cosine;
  options.consistency.depth_tolerance = mesh.consistency;
  options.single_view_weight = mesh.single_view_weight;
  options.contradicted_weight = mesh.contradicted_weight;
  options.min_component_area = mesh.component_area;
  options.min_component_extent = mesh.component_extent;
  options.tangent_distance = mesh.tangent_distance;
  options.max_hole = mesh.max_hole;
  options.face_filter = static_cast<int>(mesh.face_filter);
  return options;
}

ImageF chosen_depth(const Rendering& rendering, const MeshConfig& mesh) {
  if (mesh.depth == FusedDepth::kAgreeing)
    return agreeing_depth(rendering.depth_plane, rendering.depth_median, mesh.depth_agreement);
  return mesh.depth == FusedDepth::kPlane      ? rendering.depth_plane
         : mesh.depth == FusedDepth::kExpected ? rendering.depth_expected
                                               : rendering.depth_median;
}

FusionFrame frame_of(const LoadedRun& run, const Camera& camera, const std::string& name, const Rendering& rendering) {
  FusionFrame frame;
  frame.name = name;
  frame.camera = camera;
  frame.depth = chosen_depth(rendering, run.config().mesh);
  frame.color = rendering.color;
  frame.normal = rendering.normal;
  frame.alpha = rendering.alpha;
  frame.label = rendering.label;
  frame.label_probability = rendering.label_probability;
  return frame;
}

FusionFrame prior_frame(const LoadedRun& run, const ViewPlacement& placement, int view) {
  LoadOptions options = run.load_options();
  options.prior_depth = true;
  options.depth_factor = placement.factor;
  if (!(placement.factor > 0)) {
    throw_bad_input(run.scene().folder / "priors.json", run.scene().views[static_cast<size_t>(view)].name,
                    "nothing tells the scale of this view's prior depth",
                    "fuse rendered depth instead (without --from-prior)");
  }
  const ViewData data = load_view(run.scene(), view, options);
  if (data.prior_depth.empty()) {
    throw_bad_input(run.scene().folder / "pred_depths", data.name, "this view has no prior depth",
                    "fuse rendered depth instead (without --from-prior)");
  }
  FusionFrame frame;
  frame.name = data.name;
  frame.camera = data.camera;
  frame.depth = data.prior_depth;
  frame.color = data.color;
  return frame;
}

FusionFrame truth_frame(const LoadedRun& run, int view) {
  const View& v = run.scene().views[static_cast<size_t>(view)];
  if (v.truth_depth.empty()) {
    throw_bad_input(run.scene().folder / "truth" / "depth", v.name, "this view has no true depth",
                    "fuse rendered depth instead (without --from-truth)");
  }
  FusionFrame frame;
  frame.name = v.name;
  const ViewData data = load_view(run.scene(), view, run.load_options());
  frame.camera = v.truth_camera ? v.truth_camera->resized(data.camera.width, data.camera.height) : data.camera;
  frame.depth = load_truth_depth(run.scene(), view, frame.camera);
  frame.color = data.color;
  return frame;
}

/// Pixels that masks and ignored classes leave out, and how many of them show nothing: what hid behind was never seen.
struct HiddenPixels {
  size_t all = 0, unknown = 0;
};

/// Takes hidden pixels of a training view out of its frame.
void hide_pixels(const LoadedRun& run, int view, FusionFrame& frame, HiddenPixels& hidden) {
  LoadOptions options = run.load_options();
  options.prior_depth = options.semantics = false;
  const ImageF mask = load_view(run.scene(), view, options).mask;
  if (mask.empty()) return;
  for (size_t i = 0; i < mask.data.size(); ++i) {
    if (mask.data[i] > 0.5f) continue;
    ++hidden.all;
    hidden.unknown += frame.alpha.empty() || !(frame.alpha.data[i] >= float(run.config().mesh.alpha_min));
    frame.depth.data[i] = 0;
    if (!frame.label.empty()) frame.label.data[i] = kNoLabel;
  }
}

/// Takes the far background out of rendered frames: depth behind the measured room, where the sensor measured nothing.
void drop_far_background(const LoadedRun& run, const PriorUse& use, std::vector<FusionFrame>& frames) {
  const std::vector<int>& train = run.scene().train;
  std::vector<Camera> cameras;
  std::vector<ImageF> priors;
  for (size_t i = 0; i < train.size(); ++i) {
    LoadOptions options = run.load_options();
    options.semantics = false;
    options.prior_depth = true;
    options.depth_factor = use.depth_factor(i);
    ViewData data = load_view(run.scene(), train[i], options);
    cameras.push_back(data.camera);
    priors.push_back(std::move(data.prior_depth));
  }
  std::vector<const ImageF*> depths;
  for (const ImageF& prior : priors) depths.push_back(&prior);
  const MeasuredHull room(cameras, depths);
  if (room.empty()) return;
  const double most = FarShellSettings{}.gap * robust_extent(run.scene()) / 2;
  for (size_t i = 0; i < frames.size(); ++i) {
    FusionFrame& frame = frames[i];
    for (int y = 0; y < frame.depth.height; ++y) {
      for (int x = 0; x < frame.depth.width; ++x) {
        float& z = frame.depth.at(x, y);
        if (!is_depth(z) || (i < priors.size() && is_depth(priors[i].at(x, y)))) continue;
        if (room.outside(frame.camera.unproject(x + 0.5, y + 0.5, static_cast<double>(z))) > most) z = 0;
      }
    }
  }
}

/// A camera half-way between two: mean centre, mean rotation, the first one's intrinsics.
Camera between(const Camera& a, const Camera& b) {
  const Quaterniond p = quaternion_of(a.world_to_camera.rotation), q0 = quaternion_of(b.world_to_camera.rotation);
  const double sign = p.w * q0.w + p.x * q0.x + p.y * q0.y + p.z * q0.z < 0 ? -1 : 1;
  Camera camera = a;
  camera.world_to_camera.rotation = rotation_matrix(
      normalized(Quaterniond{p.w + sign * q0.w, p.x + sign * q0.x, p.y + sign * q0.y, p.z + sign * q0.z}));
  camera.world_to_camera.translation = -(camera.world_to_camera.rotation * ((a.centre() + b.centre()) * 0.5));
  return camera;
}

void add_interpolated(LoadedRun& run, std::vector<FusionFrame>& frames) {
  const size_t wanted = static_cast<size_t>(run.config().mesh.interpolated_views);
  const size_t pairs = run.scene().train.size() - 1;
  for (size_t k = 0; k < wanted && k < pairs; ++k) {
    const size_t i = k * pairs / std::min(wanted, pairs);
    const Camera camera =
        between(run.working_camera(run.scene().train[i]), run.working_camera(run.scene().train[i + 1]));
    frames.push_back(
        frame_of(run, camera, "between " + std::to_string(i), run.engine->render(camera, run.render_options())));
    frames.back().interpolated = true;
    frames.back().label = {};
  }
}

/// Prior depth that is nearer to the surface than rendered depth is: measured by a sensor or in the photos, or refined.
bool has_measured_prior(const Scene& scene) {
  return is_sensor_depth(scene.prior_source) || is_refined_scene(scene.folder) || scene.prior_source == kStereoDepth;
}

/// Prior depth where the frames confirm it. Returns its share per frame; empty maps where there is none.
std::vector<ImageF> take_confirmed_prior(const LoadedRun& run, std::vector<FusionFrame>& frames) {
  std::vector<ImageF> shares(frames.size());
  const Scene& scene = run.scene();
  const double agreement = run.config().mesh.prior_agreement;
  if (!(agreement > 0) || !has_measured_prior(scene)) return shares;
  const PriorUse use = decide_prior_use(scene, run.config());
  run.pool->parallel_for(scene.train.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const ImageF prior = placed_prior_depth(scene, run.config(), use, i);
      if (prior.empty()) continue;
      ConfirmedDepth confirmed = confirmed_depth(frames[i].depth, prior, agreement);
      frames[i].depth = std::move(confirmed.depth);
      shares[i] = std::move(confirmed.share);
    }
  });
  return shares;
}

/// The prior's surface where it is confirmed, walls, floor and ceiling to their planes, then every surface along its
/// normals.
void improve_depth(LoadedRun& run, std::vector<FusionFrame>& frames) {
  const MeshConfig& mesh = run.config().mesh;
  const std::vector<ImageF> confirmed = take_confirmed_prior(run, frames);
  std::vector<ImageF> drawn(frames.size());
  if (mesh.plane_reach > 0 && run.has_labels()) {
    StructuralPlanes planes;
    planes.reach = mesh.plane_reach;
    drawn = draw_to_structure(frames, run.scene().labels, planes, *run.pool);
  }
  if (!(mesh.smoothing > 0)) return;
  NormalSmoothingOptions smoothing;
  smoothing.length = mesh.smoothing;
  run.pool->parallel_for(frames.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      ImageF weight = confirmed[i].empty() ? drawn[i] : confirmed[i];
      for (size_t k = 0; k < weight.data.size(); ++k) {
        const float sure = drawn[i].empty() ? weight.data[k] : std::max(weight.data[k], drawn[i].data[k]);
        weight.data[k] = 1 + kSureCertainty * sure;
      }
      frames[i].depth = smooth_along_normals(frames[i].depth, frames[i].normal, weight, frames[i].camera, smoothing);
    }
  });
}

}  // namespace

MeshStageResult mesh_run(LoadedRun& run, const MeshStageOptions& options) {
  std::vector<FusionFrame> frames;
  HiddenPixels hidden;
  run.looks.clear();
  const DepthPlacement placement =
      options.source == DepthSource::kPrior ? place_prior_depth(run.scene()) : DepthPlacement();
  for (const int view : run.scene().train) {
    if (options.source != DepthSource::kRendered) {
      frames.push_back(options.source == DepthSource::kPrior ? prior_frame(run, placement.views[frames.size()], view)
                                                             : truth_frame(run, view));
      continue;
    }
    // The near plane of training: a camera whose estimated pose lies behind a wall would see nothing but that wall.
    RenderOptions render = run.render_options();
    render.raster.near_plane = run.near_planes()[frames.size()];
    const Camera camera = run.working_camera(view);
    const Rendering rendering = run.engine->render(camera, render);
    if (options.keep_looks) run.looks.push_back(plane_view_of(camera, rendering));
    frames.push_back(frame_of(run, camera, run.scene().views[view].name, rendering));
    hide_pixels(run, view, frames.back(), hidden);
  }
  if (hidden.all > 0) {
    log_info(
        "{:.1f} % of the pixels are masked or show ignored classes; at {:.0f} % of them nothing is known of what lies "
        "behind",
        100.0 * double(hidden.all) / double(run.scene().train.size() * frames.front().depth.pixels()),
        100.0 * double(hidden.unknown) / double(hidden.all));
  }
  const bool rendered = options.source == DepthSource::kRendered;
  if (rendered && run.config().mesh.interpolated_views > 0 && frames.size() > 1) add_interpolated(run, frames);

  if (rendered && run.config().init.far_shell && is_sensor_depth(run.scene().prior_source))
    drop_far_background(run, decide_prior_use(run.scene(), run.config()), frames);
  if (rendered) improve_depth(run, frames);
  FusionOptions fusion = fusion_options(run);
  if (options.make_device) fusion.device = options.make_device();
  FusionResult fused = fuse_depth(frames, fusion, *run.pool);
  const std::filesystem::path file = options.output.empty() ? run.folder() / "mesh" / "mesh.ply" : options.output;
  if (fused.mesh.empty() && options.may_be_empty) {
    std::filesystem::remove(file);
    return {};
  }
  if (fused.mesh.empty()) {
    throw Error({ErrorKind::kFailed,
                 "fusion found no surface",
                 run.folder(),
                 {},
                 "look at the renders: is there anything in them?"});
  }
  MeshStageResult result;
  result.fusion = fused.report;
  if (run.has_labels() && rendered) result.labels = label_mesh(fused.mesh, frames, *run.pool);
  result.file = file;
  write_mesh_ply(result.file, fused.mesh);
  const PicturedViews pictured = pictured_views(run.scene());
  const std::filesystem::path pictures = options.output.empty() && options.pictures.empty()
                                             ? run.folder() / "renders" / pictured.split / "surface"
                                             : options.pictures;
  if (!pictures.empty()) write_surface_pictures(run, fused.mesh, pictured.views, pictures);
  log_info("{}", fused.report.text());
  return result;
}

}  // namespace aligngs
