#include "refine/completed_scene.h"

#include <algorithm>

#include "core/error.h"
#include "io/folder_replacement.h"
#include "io/npy.h"
#include "io/resample.h"
#include "refine/scene_copy.h"
#include "refine/sensor_maps.h"
#include "refine/usable_views.h"
#include "scene/confidence_file.h"
#include "scene/corners.h"
#include "scene/scene_place.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct LoadedPhotos {
  std::vector<std::string> names;
  std::vector<MatchView> match;
  std::vector<ImageF> color, mask;
};

ViewData load_small(const Scene& scene, int view, int largest_width, bool depth) {
  LoadOptions load;
  load.semantics = false;
  load.prior_depth = depth;
  load.scale = std::min(1.0, static_cast<double>(largest_width) / scene.views[static_cast<size_t>(view)].camera.width);
  return load_view(scene, view, load);
}

LoadedPhotos load_photos(const Scene& scene, int largest_width, ThreadPool& pool) {
  const size_t count = scene.train.size();
  LoadedPhotos photos{std::vector<std::string>(count), std::vector<MatchView>(count), std::vector<ImageF>(count),
                      std::vector<ImageF>(count)};
  pool.parallel_for(count, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      ViewData data = load_small(scene, scene.train[i], largest_width, true);
      photos.names[i] = data.name;
      photos.match[i] = {data.camera, luma_of(data.color), std::move(data.prior_depth)};
      photos.color[i] = std::move(data.color);
      photos.mask[i] = std::move(data.mask);
    }
  });
  return photos;
}

/// Test photos, which are only placed by the points of the others.
std::vector<RefineView> load_tests(const Scene& scene, int largest_width, ThreadPool& pool) {
  std::vector<RefineView> tests(scene.test.size());
  pool.parallel_for(tests.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      ViewData data = load_small(scene, scene.test[i], largest_width, false);
      RefineView& view = tests[i];
      view.name = data.name;
      view.match = {data.camera, luma_of(data.color), {}};
      view.color = std::move(data.color);
      view.mask = std::move(data.mask);
      view.test = true;
    }
  });
  return tests;
}

/// The photos' cameras are the corrected ones afterwards.
void check_cameras(const Scene& scene, const CompleteSceneOptions& options, ThreadPool& pool, LoadedPhotos& photos,
                   CompleteSceneReport& report) {
  constexpr uint64_t kSteps = 100;
  Progress progress(options.progress, "check cameras", kSteps);
  std::vector<RefineView> views;
  for (size_t i = 0; i < photos.match.size(); ++i) {
    views.emplace_back();
    views.back().name = photos.names[i];
    views.back().match = std::move(photos.match[i]);
    views.back().color = std::move(photos.color[i]);
    views.back().mask = std::move(photos.mask[i]);
  }
  if (options.correct_cameras) {
    for (RefineView& test : load_tests(scene, options.largest_width, pool)) views.push_back(std::move(test));
  }
  report.cameras =
      check_sensor_cameras(views, robust_extent(scene), options.correct_cameras, options.camera_settings, pool,
                           [&](double share) { progress.update(static_cast<uint64_t>(share * kSteps)); });
  report.corrected = report.cameras.corrected;
  for (size_t i = 0; i < photos.match.size(); ++i) {
    photos.match[i] = std::move(views[i].match);
    photos.match[i].camera = report.cameras.cameras[i];
    photos.color[i] = std::move(views[i].color);
    photos.mask[i] = std::move(views[i].mask);
  }
}

/// Corrected cameras of all views at the size of their photos.
std::vector<Camera> corrected_cameras(const Scene& scene, const std::vector<Camera>& corrected) {
  std::vector<Camera> cameras;
  for (const View& view : scene.views) cameras.push_back(view.camera);
  std::vector<int> views = scene.train;
  views.insert(views.end(), scene.test.begin(), scene.test.end());
  for (size_t i = 0; i < corrected.size(); ++i) {
    Camera& camera = cameras[static_cast<size_t>(views[i])];
    camera = corrected[i].resized(camera.width, camera.height);
  }
  return cameras;
}

double span_of(const std::vector<Vec3f>& log_gains) {
  double span = 0;
  for (int c = 0; c < 3 && !log_gains.empty(); ++c) {
    const auto [least, most] = std::minmax_element(log_gains.begin(), log_gains.end(),
                                                   [&](const Vec3f& a, const Vec3f& b) { return a[c] < b[c]; });
    span = std::max(span, static_cast<double>((*most)[c]) - (*least)[c]);
  }
  return span;
}

void require_depth(const Scene& scene) {
  for (const int v : scene.train) {
    const View& view = scene.views[static_cast<size_t>(v)];
    if (view.prior_depth.empty())
      throw_bad_input(scene.folder / "pred_depths", view.name, "this training view has no prior depth",
                      "add it, or train without this step");
  }
}

void measure_exposure(const LoadedPhotos& photos, const CompleteSceneOptions& options, ThreadPool& pool,
                      CompleteSceneReport& report) {
  std::vector<ExposureView> views;
  for (size_t i = 0; i < photos.match.size(); ++i)
    views.push_back({&photos.match[i], &photos.color[i], &photos.mask[i]});
  report.log_gains = estimate_log_gains(views, options.exposure_settings, pool);
  report.span = span_of(report.log_gains);
  report.exposed = report.span >= options.least_span;
}

/// The sensor's maps without mixed pixels; empty where nothing is to be cleaned. The photos' depth follows.
std::vector<SensorDepth> clean_depth(const Scene& scene, const CompleteSceneOptions& options, ThreadPool& pool,
                                     LoadedPhotos& photos, CompleteSceneReport& report) {
  const size_t count = photos.match.size();
  std::vector<SensorDepth> maps(count);
  pool.parallel_for(count, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i)
      maps[i] = clean_sensor_maps(scene, scene.train[i], photos.match[i].luma, options.clean_settings);
  });
  for (const SensorDepth& map : maps) {
    report.mixed += map.mixed / static_cast<double>(count);
    report.doubtful += map.doubtful / static_cast<double>(count);
  }
  if (report.mixed + report.doubtful < options.least_cleaned) return {};
  report.cleaned = true;
  for (size_t i = 0; i < count; ++i) {
    ImageF& depth = photos.match[i].depth;
    const ImageF clean = resize_depth(maps[i].depth, depth.width, depth.height);
    for (size_t p = 0; p < depth.data.size(); ++p) depth.data[p] = depth.data[p] > 0 ? clean.data[p] : 0;
  }
  return maps;
}

/// Confidence of filled maps where the sensor measured: its own, 1 at most.
void keep_sensor_confidence(const std::vector<SensorDepth>& cleaned, const LoadedPhotos& photos,
                            std::vector<HoleDepth>& filled) {
  for (size_t i = 0; i < cleaned.size() && i < filled.size(); ++i) {
    ImageF& out = filled[i].confidence;
    const ImageF own = resize_nearest(cleaned[i].confidence, out.width, out.height);
    const float most = *std::max_element(own.data.begin(), own.data.end());
    for (size_t p = 0; p < out.data.size(); ++p) {
      if (photos.match[i].depth.data[p] > 0 && own.data[p] > 0) out.data[p] = own.data[p] / most;
    }
  }
}

double share_of_holes(const LoadedPhotos& photos) {
  double holes = 0;
  for (const MatchView& view : photos.match) {
    const auto empty = std::count_if(view.depth.data.begin(), view.depth.data.end(), [](float z) { return !(z > 0); });
    holes += static_cast<double>(empty) / static_cast<double>(view.depth.data.size() * photos.match.size());
  }
  return holes;
}

std::vector<HoleDepth> measure_holes(const Scene& scene, const LoadedPhotos& photos,
                                     const CompleteSceneOptions& options, ThreadPool& pool,
                                     CompleteSceneReport& report) {
  constexpr uint64_t kSteps = 100;
  Progress progress(options.progress, "fill holes of depth", kSteps);
  std::vector<HoleDepth> filled =
      fill_depth_holes(photos.match, scene.cloud.positions, options.hole_settings, pool,
                       [&](double share) { progress.update(static_cast<uint64_t>(share * kSteps)); });
  std::vector<double> disagreements;
  for (size_t i = 0; i < filled.size(); ++i) {
    for (size_t p = 0; p < photos.mask[i].data.size(); ++p) {  // a mask is no hole
      if (!(photos.mask[i].data[p] > 0.5f)) filled[i].depth.data[p] = filled[i].confidence.data[p] = 0;
    }
    report.filled += filled[i].filled / static_cast<double>(filled.size());
    disagreements.push_back(filled[i].disagreement);
  }
  std::sort(disagreements.begin(), disagreements.end());
  report.disagreement = disagreements[disagreements.size() / 2];
  report.completed = report.filled > 0;
  return filled;
}

void write_maps(const LoadedPhotos& photos, const std::vector<HoleDepth>& filled, const fs::path& folder) {
  for (const char* maps : {"pred_depths", "pred_confidence"}) fs::remove_all(folder / maps);
  for (size_t i = 0; i < filled.size(); ++i) {
    write_npy_float32(folder / "pred_depths" / (photos.names[i] + ".npy"),
                      {filled[i].depth.height, filled[i].depth.width}, filled[i].depth.data.data());
    write_confidence(folder, photos.names[i], filled[i].confidence);
  }
}

}  // namespace

CompleteSceneReport complete_scene(Scene scene, const fs::path& output, const CompleteSceneOptions& options,
                                   ThreadPool& pool) {
  require_depth(scene);
  const std::vector<fs::path> sources =
      options.in_place ? std::vector<fs::path>{} : std::vector<fs::path>{scene.folder};
  require_scene_place(output, options.overwrite, sources);
  LoadedPhotos photos;
  load_usable_views(scene, [&] { photos = load_photos(scene, options.largest_width, pool); });
  CompleteSceneReport report;
  if (options.check_cameras || options.correct_cameras) check_cameras(scene, options, pool, photos, report);
  std::vector<SensorDepth> cleaned;
  if (options.clean && is_sensor_depth(scene.prior_source)) cleaned = clean_depth(scene, options, pool, photos, report);
  if (options.exposure) measure_exposure(photos, options, pool, report);
  report.holes = share_of_holes(photos);
  std::vector<HoleDepth> filled;
  if (options.holes && report.holes >= options.least_holes)
    filled = measure_holes(scene, photos, options, pool, report);
  if (!report.corrected && !report.exposed && !report.cleaned && !report.completed) return report;
  if (report.completed) keep_sensor_confidence(cleaned, photos, filled);
  FolderReplacement replacement(output);
  copy_scene(scene.folder, replacement.path());
  write_used_split(scene, replacement.path());
  if (report.corrected)
    write_scene_cameras(scene, corrected_cameras(scene, report.cameras.cameras), replacement.path());
  if (report.exposed) write_training_exposure(scene, report.log_gains, replacement.path());
  if (report.completed)
    write_maps(photos, filled, replacement.path());
  else
    for (size_t i = 0; i < cleaned.size(); ++i)
      write_sensor_maps(scene, scene.train[i], cleaned[i], replacement.path());
  mark_as_own(replacement.path());
  place_scene(replacement, options.overwrite, sources);
  return report;
}

}  // namespace aligngs
