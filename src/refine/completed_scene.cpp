#include "refine/completed_scene.h"

#include <algorithm>

#include "core/error.h"
#include "io/folder_replacement.h"
#include "io/npy.h"
#include "refine/scene_copy.h"
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

LoadedPhotos load_photos(const Scene& scene, int largest_width, ThreadPool& pool) {
  const size_t count = scene.train.size();
  LoadedPhotos photos{std::vector<std::string>(count), std::vector<MatchView>(count), std::vector<ImageF>(count),
                      std::vector<ImageF>(count)};
  pool.parallel_for(count, 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      LoadOptions load;
      load.semantics = false;
      load.scale = std::min(
          1.0, static_cast<double>(largest_width) / scene.views[static_cast<size_t>(scene.train[i])].camera.width);
      ViewData data = load_view(scene, scene.train[i], load);
      photos.names[i] = data.name;
      photos.match[i] = {data.camera, luma_of(data.color), std::move(data.prior_depth)};
      photos.color[i] = std::move(data.color);
      photos.mask[i] = std::move(data.mask);
    }
  });
  return photos;
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
  if (options.exposure) measure_exposure(photos, options, pool, report);
  report.holes = share_of_holes(photos);
  std::vector<HoleDepth> filled;
  if (options.holes && report.holes >= options.least_holes)
    filled = measure_holes(scene, photos, options, pool, report);
  if (!report.exposed && !report.completed) return report;
  FolderReplacement replacement(output);
  copy_scene(scene.folder, replacement.path());
  write_used_split(scene, replacement.path());
  if (report.exposed) write_training_exposure(scene, report.log_gains, replacement.path());
  if (report.completed) write_maps(photos, filled, replacement.path());
  mark_as_own(replacement.path());
  require_scene_place(output, options.overwrite, sources);  // filled meanwhile?
  replacement.commit();
  return report;
}

}  // namespace aligngs
