#include "refine/measured_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "io/folder_replacement.h"
#include "io/npy.h"
#include "refine/scene_copy.h"
#include "refine/usable_views.h"
#include "scene/confidence_file.h"
#include "scene/corners.h"
#include "scene/scene_json.h"
#include "scene/scene_place.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct TrainingPhotos {
  std::vector<std::string> names;
  std::vector<MatchView> match;
  std::vector<ImageF> color, mask;
  std::vector<Image<uint16_t>> labels;  ///< empty images where planes are not looked for
};

bool uses_planes(const Scene& scene, const MeasureSceneOptions& options) {
  return options.planes && scene.has_semantics();
}

TrainingPhotos load_photos(const Scene& scene, const MeasureSceneOptions& options, ThreadPool& pool) {
  const size_t count = scene.train.size();
  TrainingPhotos photos{std::vector<std::string>(count), std::vector<MatchView>(count), std::vector<ImageF>(count),
                        std::vector<ImageF>(count), std::vector<Image<uint16_t>>(count)};
  pool.parallel_for(count, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      LoadOptions load;
      load.prior_depth = false;
      load.semantics = uses_planes(scene, options);
      load.scale = std::min(1.0, static_cast<double>(options.largest_width) /
                                     scene.views[static_cast<size_t>(scene.train[i])].camera.width);
      ViewData data = load_view(scene, scene.train[i], load);
      photos.names[i] = data.name;
      photos.match[i] = {data.camera, luma_of(data.color), {}};
      photos.color[i] = std::move(data.color);
      photos.mask[i] = std::move(data.mask);
      photos.labels[i] = std::move(data.labels);
    }
  });
  return photos;
}

std::vector<PhotoDepth> measure(const Scene& scene, const TrainingPhotos& photos, const MeasureSceneOptions& options,
                                ThreadPool& pool) {
  constexpr uint64_t kSteps = 100;
  Progress progress(options.progress, "measure depth", kSteps);
  return photo_depth(photos.match, scene.cloud.positions, options.settings, pool,
                     [&](double share) { progress.update(static_cast<uint64_t>(share * kSteps)); });
}

std::vector<Vec3f> measure_exposure(TrainingPhotos& photos, const std::vector<PhotoDepth>& depths,
                                    const MeasureSceneOptions& options, ThreadPool& pool) {
  std::vector<ExposureView> views;
  for (size_t i = 0; i < depths.size(); ++i) {
    photos.match[i].depth = depths[i].depth;
    for (size_t p = 0; p < depths[i].depth.data.size(); ++p) {
      // what is not certain may be another surface
      if (depths[i].certainty.data[p] <= 0) photos.match[i].depth.data[p] = 0;
    }
    views.push_back({&photos.match[i], &photos.color[i], &photos.mask[i]});
  }
  return estimate_log_gains(views, options.exposure_settings, pool);
}

void write_depth(const std::string& name, const Camera& camera, const PhotoDepth& depth, const fs::path& folder) {
  ImageF map = depth.depth, certainty = depth.certainty;
  if (map.empty()) map = certainty = ImageF(camera.width, camera.height, 1);
  write_npy_float32(folder / "pred_depths" / (name + ".npy"), {map.height, map.width}, map.data.data());
  write_confidence(folder, name, certainty);
}

void note_depth(const fs::path& folder, double measured) {
  PriorsJson priors = read_priors_json(folder / "priors.json");
  priors.depth = PriorJson{kStereoDepth, "", {{"measured", fmt::format("{:.3f}", measured)}}};
  priors.depth_scale = DepthScale::kScene;
  write_priors_json(folder / "priors.json", priors);
}

}  // namespace

MeasureSceneReport measure_scene(Scene scene, const fs::path& output, const MeasureSceneOptions& options,
                                 ThreadPool& pool) {
  if (scene.cloud.size() == 0) {
    throw_bad_input(scene.folder / "sparse", "points3D",
                    "there are no points, which say how near and far the photos see",
                    "take cameras and points from structure from motion (`aligngs poses --method colmap`)");
  }
  const std::vector<fs::path> sources =
      options.in_place ? std::vector<fs::path>{} : std::vector<fs::path>{scene.folder};
  require_scene_place(output, options.overwrite, sources);
  TrainingPhotos photos;
  load_usable_views(scene, [&] { photos = load_photos(scene, options, pool); });
  std::vector<PhotoDepth> depths = measure(scene, photos, options, pool);
  MeasureSceneReport report;
  for (const PhotoDepth& depth : depths) {
    report.measured += depth.measured / static_cast<double>(depths.size());
    report.views += depth.measured > 0;
  }
  if (report.views == 0) return report;
  KnownSurfaces known;
  if (uses_planes(scene, options)) {
    LabelledDepthSettings settings = options.plane_settings;
    settings.spread = options.settings.stereo.spread;
    const FlatClasses classes = flat_classes(scene.labels, options.surfaces, options.panels);
    report.planes = lay_on_planes(photos.match, photos.labels, classes, settings, pool, depths);
    if (options.bare_planes)
      known = known_surfaces(photos.match, photos.labels, depths, report.planes, classes, settings, pool);
  }
  if (options.bare_planes) {
    report.bare = lay_on_bare_planes(photos.match, photos.labels, options.bare_settings, options.settings.stereo, pool,
                                     depths, known);
  }
  if (options.exposure) report.log_gains = measure_exposure(photos, depths, options, pool);
  FolderReplacement replacement(output);
  const fs::path& folder = replacement.path();
  copy_scene(scene.folder, folder);
  write_used_split(scene, folder);
  for (const char* maps : {"pred_depths", "pred_confidence"}) fs::remove_all(folder / maps);
  for (size_t i = 0; i < depths.size(); ++i) write_depth(photos.names[i], photos.match[i].camera, depths[i], folder);
  note_depth(folder, report.measured);
  if (options.exposure) write_training_exposure(scene, report.log_gains, folder);
  mark_as_own(folder);
  place_scene(replacement, options.overwrite, sources);
  return report;
}

}  // namespace aligngs
