#include "refine/refined_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/folder_replacement.h"
#include "io/json_text.h"
#include "io/npy.h"
#include "io/resample.h"
#include "refine/known_surfaces.h"
#include "refine/measured_factors.h"
#include "refine/scene_copy.h"
#include "refine/usable_views.h"
#include "scene/depth_placement.h"
#include "scene/prior_maps.h"
#include "scene/scene_json.h"
#include "scene/scene_place.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Photos of refinement: the training photos, then, if asked for, the test photos.
struct ScenePhotos {
  std::vector<RefineView> views;
  std::vector<Image<uint16_t>> labels;  ///< of the training photos; empty images where planes are not looked for
};

ScenePhotos load_photos(const Scene& scene, const DepthPlacement& placement, const RefineSceneOptions& options,
                        ThreadPool& pool) {
  std::vector<int> indices = scene.train;
  const size_t training = indices.size();
  const bool labels = uses_planes(scene, options);
  if (options.register_tests) indices.insert(indices.end(), scene.test.begin(), scene.test.end());
  ScenePhotos photos;
  photos.views.resize(indices.size());
  photos.labels.resize(training);
  pool.parallel_for(indices.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      LoadOptions load;
      load.prior_depth = i < training;  // a test view's prior is not read
      if (i < training) load.depth_factor = placement.views[i].factor;
      load.semantics = labels && i < training;
      ViewData data = load_view(scene, indices[i], load);
      RefineView& view = photos.views[i];
      view.name = data.name;
      view.match.camera = data.camera;
      view.match.luma = luma_of(data.color);
      view.match.depth = std::move(data.prior_depth);
      view.color = std::move(data.color);
      view.mask = std::move(data.mask);
      view.test = i >= training;
      if (i < training) photos.labels[i] = std::move(data.labels);
    }
  });
  return photos;
}

void require_depth_of_all(const Scene& scene) {
  for (const int v : scene.train) {
    if (!scene.views[static_cast<size_t>(v)].prior_depth.empty()) continue;
    throw_bad_input(
        scene.folder / "pred_depths", scene.views[static_cast<size_t>(v)].name,
        "this training view has no prior depth, which says where to look for its points in other photos",
        "make it with `aligngs priors`, or take cameras from structure from motion (`aligngs poses --method colmap`)");
  }
}

/// The factors of the prior depth to scene units. Every photo needs one.
DepthPlacement placed_depth(const Scene& scene) {
  require_depth_of_all(scene);
  DepthPlacement placement = place_prior_depth(scene);
  for (size_t i = 0; i < placement.views.size(); ++i) {
    if (placement.views[i].factor > 0) continue;
    throw_bad_input(scene.folder / "priors.json", scene.views[static_cast<size_t>(scene.train[i])].name,
                    fmt::format("nothing tells the scale of this view's prior depth ({})", describe(placement)),
                    "give the scene points (sparse/points3D), or depth that was made with its cameras");
  }
  return placement;
}

/// The grid's log factor at every pixel.
ImageF grid_factor(const DepthGrid& grid, int width, int height) {
  ImageF out(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<float>(grid.at((x + 0.5) / width, (y + 0.5) / height));
  }
  return out;
}

void add_to(ImageF& sum, const ImageF& factor) {
  for (size_t i = 0; i < factor.data.size(); ++i) sum.data[i] += factor.data[i];
}

/// Multiplies valid depth by exp(log_factor), a map of the same shape or not.
void apply(const ImageF& log_factor, ImageF& depth) {
  const ImageF factor = resize_bilinear(log_factor, depth.width, depth.height);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    if (depth.data[i] > 0 && std::isfinite(depth.data[i])) depth.data[i] *= std::exp(factor.data[i]);
  }
}

void write_depth(const Scene& scene, int view, double factor, const ImageF& log_factor, const fs::path& folder) {
  const View& v = scene.views[static_cast<size_t>(view)];
  const FloatArray stored = read_npy(v.prior_depth);
  if (stored.shape.size() < 2) throw_bad_input(v.prior_depth, "shape", "is no map", "store depth as [height, width]");
  ImageF map(static_cast<int>(stored.shape[stored.shape.size() - 1]),
             static_cast<int>(stored.shape[stored.shape.size() - 2]), 1);
  map.data = stored.data;
  for (float& z : map.data) z *= static_cast<float>(factor);
  apply(log_factor, map);
  write_npy_float32(folder / "pred_depths" / v.prior_depth.filename(), {map.height, map.width}, map.data.data());
}

/// The training photos with the refined cameras and the prior depth as their grids correct it.
std::vector<MatchView> corrected_photos(const std::vector<RefineView>& views, size_t training,
                                        const RefineResult& refined) {
  std::vector<MatchView> photos;
  for (size_t i = 0; i < training; ++i) {
    MatchView photo = views[i].match;
    photo.camera = refined.views[i].camera;
    refined.views[i].depth.apply(photo.depth);
    photos.push_back(std::move(photo));
  }
  return photos;
}

constexpr const char* kRefined = "cameras_refined";  // of scene.json

/// An empty object when there is none.
nlohmann::ordered_json read_description(const fs::path& file) {
  if (!fs::exists(file)) return nlohmann::ordered_json::object();
  nlohmann::ordered_json json = parse_ordered_json(read_file(file));
  return json.is_object() ? json : nlohmann::ordered_json::object();
}

void note_refinement(const RefineResult& result, const fs::path& folder) {
  const fs::path file = folder / "scene.json";
  nlohmann::ordered_json json = read_description(file);
  json[kRefined] = {{"tracks", result.tracks},
                    {"reprojection_median_before_px", result.bundle.start_median},
                    {"reprojection_median_px", result.bundle.end_median},
                    {"focal_factor", result.focal_factor}};
  write_file_atomically(file, json_document(json));
}

/// Depth of test views is not corrected: it would keep the scale and the cameras that the scene has left.
void remove_test_depth(const Scene& scene, const fs::path& folder) {
  for (const int v : scene.test) {
    const fs::path& map = scene.views[static_cast<size_t>(v)].prior_depth;
    if (!map.empty()) fs::remove(folder / "pred_depths" / map.filename());
  }
}

/// The corrected depth is in scene units, whatever it was before.
void note_scene_depth(const fs::path& folder) {
  PriorsJson priors = read_priors_json(folder / "priors.json");
  if (!priors.depth) priors.depth.emplace();  // of unknown origin
  priors.depth->settings.erase("units");
  priors.depth_scale = DepthScale::kScene;
  write_priors_json(folder / "priors.json", priors);
}

/// One pass over all photos: cameras, then depth. The photos' views come out as they are known afterwards. Returns how
/// sure their depth is.
std::vector<ImageF> refine_once(const Scene& scene, const RefineSceneOptions& options, ThreadPool& pool,
                                ScenePhotos& photos, std::vector<ImageF>& log_factors, RefineSceneReport& report) {
  std::vector<RefineView>& views = photos.views;
  const size_t training = scene.train.size();
  const RefineResult before = report.cameras;
  const bool first = before.views.empty();
  {
    constexpr uint64_t kSteps = 100;
    Progress progress(options.progress, "refine cameras", kSteps);
    report.cameras = refine_cameras(views, robust_extent(scene), options.settings, pool,
                                    [&](double share) { progress.update(static_cast<uint64_t>(share * kSteps)); });
  }
  if (!first) {  // the report starts with the cameras of the input
    report.cameras.bundle.start_rms = before.bundle.start_rms;
    report.cameras.bundle.start_median = before.bundle.start_median;
    report.cameras.focal_factor *= before.focal_factor;
    for (size_t i = 0; i < views.size(); ++i) report.cameras.views[i].misplaced |= before.views[i].misplaced;
  }
  MeasuredFactors measured{std::vector<ImageF>(training), {}};
  if (options.correct_depth)
    measured = measured_factors(scene, corrected_photos(views, training, report.cameras), photos.labels, options, pool,
                                report);
  for (size_t i = 0; i < views.size(); ++i) {
    views[i].match.camera = report.cameras.views[i].camera;
    if (i >= training || !options.correct_depth) continue;
    ImageF factor = grid_factor(report.cameras.views[i].depth, views[i].match.depth.width, views[i].match.depth.height);
    add_to(factor, measured.log_factors[i]);
    apply(factor, views[i].match.depth);
    add_to(log_factors[i], factor);
  }
  return std::move(measured.certainty);
}

bool any_labels(const ScenePhotos& photos) {
  return std::any_of(photos.labels.begin(), photos.labels.end(), [](const auto& map) { return !map.empty(); });
}

/// The planes and panels that labels have found, and which pixels lie on them.
KnownSurfaces known_surfaces(const Scene& scene, const RefineSceneOptions& options, const ScenePhotos& photos,
                             const std::vector<ImageF>& certainty, const RefineSceneReport& report, ThreadPool& pool) {
  std::vector<PlaneView> views(photos.labels.size());
  for (size_t i = 0; i < views.size(); ++i) {
    const MatchView& photo = photos.views[i].match;
    views[i] = {photo.camera, photo.depth, certainty[i], photos.labels[i], {}};
  }
  return known_surfaces(views, {report.planes, report.axes, report.panels},
                        flat_classes(scene.labels, options.surfaces, options.panels),
                        {options.plane_settings, options.panel_settings}, pool);
}

/// Moves the depth of the training photos, whose pixels are as sure as `certainty`, onto planes of what was measured.
void lay_on_planes_of_all(const RefineSceneOptions& options, const std::vector<ImageF>& certainty,
                          const KnownSurfaces& known, ThreadPool& pool, ScenePhotos& photos,
                          std::vector<ImageF>& log_factors, RefineSceneReport& report) {
  std::vector<MatchView> match;
  for (size_t i = 0; i < log_factors.size(); ++i) match.push_back(photos.views[i].match);
  const BarePlaneFactors factors =
      bare_plane_factors(match, photos.labels, certainty, options.bare_settings, options.stereo_settings, known, pool);
  report.bare = factors.report;
  for (size_t i = 0; i < log_factors.size(); ++i) {
    apply(factors.log_factors[i], photos.views[i].match.depth);
    add_to(log_factors[i], factors.log_factors[i]);
  }
}

/// How the training photos' exposures differ, by cameras and depth as they are known now.
std::vector<Vec3f> measure_exposure(const ScenePhotos& photos, size_t training, const RefineSceneOptions& options,
                                    ThreadPool& pool) {
  std::vector<ExposureView> views;
  for (size_t i = 0; i < training; ++i)
    views.push_back({&photos.views[i].match, &photos.views[i].color, &photos.views[i].mask});
  return estimate_log_gains(views, options.exposure_settings, pool);
}

}  // namespace

RefineSceneReport refine_scene(Scene scene, const fs::path& output, const RefineSceneOptions& options,
                               ThreadPool& pool) {
  const std::vector<fs::path> sources =
      options.in_place ? std::vector<fs::path>{} : std::vector<fs::path>{scene.folder};
  require_scene_place(output, options.overwrite, sources);
  DepthPlacement placement;
  ScenePhotos photos;
  load_usable_views(scene, [&] {
    placement = placed_depth(scene);
    photos = load_photos(scene, placement, options, pool);
  });
  const std::vector<RefineView>& views = photos.views;
  const size_t training = scene.train.size();
  const auto index_of = [&](size_t i) {
    return static_cast<size_t>(i < training ? scene.train[i] : scene.test[i - training]);
  };
  std::vector<ImageF> log_factors;
  for (size_t i = 0; i < training; ++i)
    log_factors.emplace_back(views[i].match.depth.width, views[i].match.depth.height, 1);
  RefineSceneReport report;
  report.depth_placement = describe(placement);
  for (const RefineView& view : views) report.names.push_back(view.name);
  std::vector<ImageF> certainty;
  for (int pass = 0; pass < options.passes; ++pass)
    certainty = refine_once(scene, options, pool, photos, log_factors, report);
  if (options.bare_planes && !certainty.empty() && any_labels(photos))
    lay_on_planes_of_all(options, certainty, known_surfaces(scene, options, photos, certainty, report, pool), pool,
                         photos, log_factors, report);
  if (options.exposure) report.log_gains = measure_exposure(photos, training, options, pool);
  std::vector<Camera> cameras;
  for (const View& v : scene.views) cameras.push_back(v.camera);
  for (size_t i = 0; i < views.size(); ++i) {
    cameras[index_of(i)] = report.cameras.views[i].camera;
    measure_change(scene.views[index_of(i)].camera, report.cameras.views[i]);
  }
  FolderReplacement replacement(output);
  const fs::path& folder = replacement.path();
  copy_scene(scene.folder, folder);
  write_used_split(scene, folder);
  write_scene_cameras(scene, cameras, folder);
  for (size_t i = 0; options.correct_depth && i < training; ++i) {
    write_depth(scene, scene.train[i], placement.views[i].factor, log_factors[i], folder);
  }
  if (options.correct_depth) {
    remove_test_depth(scene, folder);
    note_scene_depth(folder);
  }
  if (options.exposure) write_training_exposure(scene, report.log_gains, folder);
  note_refinement(report.cameras, folder);
  mark_as_own(folder);
  place_scene(replacement, options.overwrite, sources);
  return report;
}

bool is_refined_scene(const fs::path& folder) { return read_description(folder / "scene.json").contains(kRefined); }

}  // namespace aligngs
