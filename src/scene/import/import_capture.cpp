#include "scene/import/import_capture.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "core/log.h"
#include "io/image_file.h"
#include "io/output_place.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_split.h"
#include "scene/import/prepared_frame.h"
#include "scene/import/sensor_cloud.h"
#include "scene/mesh_ply.h"
#include "scene/scene_check.h"
#include "scene/scene_writer.h"
#include "scene/unused_masks.h"
#include "scene/up_direction.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Everything that is read: what was given, and the folders of the files that it refers to elsewhere.
std::vector<fs::path> sources_of(const Capture& capture, const ImportOptions& options) {
  std::set<fs::path> folders;
  for (const CapturedFrame& frame : capture.frames) {
    for (const fs::path& file : {frame.image, frame.depth, frame.confidence, frame.mask}) {
      if (!file.empty()) folders.insert(real_place(file).parent_path());
    }
  }
  std::vector<fs::path> sources = options.sources.empty() ? std::vector<fs::path>{capture.folder} : options.sources;
  sources.insert(sources.end(), {options.sfm, capture.mesh});
  sources.insert(sources.end(), folders.begin(), folders.end());
  return sources;
}

/// Up as the layout has it, unless the cameras contradict; else from the floor or the cameras.
void set_up(const Capture& capture, SceneParts& parts) {
  std::vector<ViewUp> views;
  for (const CapturedFrame& frame : capture.frames) {
    views.push_back(view_up(frame.world_to_camera, frame.upright ? 1 : read_image_info(frame.image).orientation));
  }
  if (capture.up && agrees_with(views, *capture.up, capture.up_measured)) {
    parts.description.up = capture.up;
    parts.description.up_source = capture.up_source;
    return;
  }
  std::vector<Vec3d> points;
  for (const Vec3f& p : parts.cloud.positions) points.push_back(p.cast<double>());
  const auto up = estimate_up(views, {}, points);
  if (!up) return;
  parts.description.up = up->direction;
  parts.description.up_source = up->source;
}

PointCloud narrow(const CapturedCloud& cloud) {
  PointCloud out;
  for (const Vec3d& p : cloud.positions) out.positions.push_back(p.cast<float>());
  out.colors = cloud.colors;
  return out;
}

/// The reference mesh in the capture's world.
void set_truth_mesh(const Capture& capture, SceneParts& parts) {
  if (capture.mesh.empty() || !capture.to_original) {
    parts.truth_mesh_file = capture.mesh;
    return;
  }
  parts.truth_mesh = read_mesh_ply(capture.mesh);
  const Similarity from_original = capture.to_original->inverse();
  for (Vec3f& vertex : parts.truth_mesh.vertices) vertex = (from_original * vertex.cast<double>()).cast<float>();
}

/// Masks of the capture that hide nothing. The scene has its masks in the alpha of its photos.
void warn_of_unused_masks(const Capture& capture, const ImportOptions& options) {
  std::vector<fs::path> photos, named;
  for (const CapturedFrame& frame : capture.frames) {
    photos.push_back(frame.image);
    if (!frame.mask.empty()) named.push_back(frame.mask);
  }
  const fs::path& folder = options.photos.empty() ? capture.folder : options.photos;
  for (const SceneProblem& problem : unused_masks(folder, photos, named))
    log_warning("{}", text_of_unused_masks(problem));
}

/// One of each kind first, and cameras before all: few lines are shown, and a wrong camera spoils everything.
void order_by_kind(std::vector<SceneProblem>& problems) {
  std::map<std::string, size_t> seen;
  std::vector<std::pair<std::pair<size_t, bool>, SceneProblem>> ranked;
  for (SceneProblem& problem : problems)
    ranked.push_back({{seen[problem.field]++, problem.field != "camera"}, std::move(problem)});
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  problems.clear();
  for (auto& [rank, problem] : ranked) problems.push_back(std::move(problem));
}

/// The same check that training begins with; views that it refuses leave the split.
void check_as_training_does(const fs::path& folder, SplitJson& split, ImportReport& report) {
  Scene scene = open_scene(folder);
  std::vector<SceneProblem> problems = leave_out_bad_views(scene, check_scene(scene));
  order_by_kind(problems);
  for (const SceneProblem& problem : problems) {
    if (problem.fatal) throw_bad_input(problem.path, problem.field, problem.message, problem.remedy);
    if (problem.field == kDepthOfViews) continue;  // SensorCloud has asked, and tells the unit of the files
    const std::string place = problem.path.lexically_relative(folder).generic_string();
    report.warnings.push_back((place == "." ? "" : place + ": ") + problem.message);
  }
  if (scene.left_out.empty()) return;
  report.left_out.insert(report.left_out.end(), scene.left_out.begin(), scene.left_out.end());
  for (const LeftOut& view : scene.left_out) {
    for (auto* list : {&*split.train, &*split.test}) std::erase(*list, view.name);
  }
  write_split_json(folder / "split.json", split);
}

}  // namespace

ImportReport import_capture(const Capture& capture, const fs::path& output, const ImportOptions& options,
                            ThreadPool& pool) {
  const std::vector<fs::path> sources = sources_of(capture, options);
  require_scene_place(output, options.overwrite, sources);  // before views are chosen, which takes long
  const CaptureSplit selection = split_capture(capture, options, pool);
  SceneWriter writer(output, options.overwrite, sources);
  warn_of_unused_masks(capture, options);
  ImportReport report;
  report.left_out = capture.left_out;
  const bool use_sfm = !options.sfm.empty();

  SensorCloud sensor;
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  Progress progress(options.progress, "import", selection.train.size() + selection.test.size());
  size_t done = 0;
  for (const bool train : {true, false}) {
    for (const int index : train ? selection.train : selection.test) {
      const CapturedFrame& captured = capture.frames[static_cast<size_t>(index)];
      use_or_leave_out(captured.name, report.left_out, [&] {
        PreparedFrame frame = prepare_frame(capture, captured, options);
        const bool depth_prior = train && !use_sfm && !frame.depth.empty() && options.depth_prior;
        if (train && !use_sfm && !frame.depth.empty()) sensor.add(frame.parts.camera, frame.depth, frame.pixels);
        if (depth_prior) frame.parts.prior_depth = frame.depth;
        report.depth_prior = report.depth_prior || depth_prior;
        if (capture.metric) frame.parts.truth_depth = std::move(frame.depth);
        writer.add_view(frame.parts);
        (train ? *parts.split.train : *parts.split.test).push_back(frame.parts.name);
      });
      progress.update(++done);
    }
  }
  const auto require_enough_frames = [&] {
    const size_t kept = parts.split.train->size() + parts.split.test->size();
    const bool few = parts.split.train->size() < kFewestTrainingViews;
    require_enough(capture.folder, kept, report.left_out, few ? kept + 1 : 0, options.strict);
  };
  require_enough_frames();

  if (use_sfm) {
    AlignedSfm sfm = align_sfm(capture, options.sfm);
    report.cloud_source = "sfm";
    report.sfm_rmse = sfm.rmse;
    report.sfm_cameras = sfm.cameras;
    parts.cloud = std::move(sfm.cloud);
  } else if (!sensor.empty()) {
    report.cloud_source = "sensor depth";
    const std::string warning = sensor.contradiction(capture.metric, capture.depth_unit, narrow(capture.cloud));
    if (!warning.empty()) report.warnings.push_back(warning);
    parts.cloud = sensor.fuse(options.voxel, pool);
  } else if (capture.cloud.size() > 0) {
    report.cloud_source = "capture";
    parts.cloud = narrow(capture.cloud);
  } else {
    report.cloud_source = "none";
  }
  report.points = parts.cloud.size();
  parts.description.metric = capture.metric;
  parts.description.source = capture.layout + ", cloud from " + report.cloud_source;
  parts.description.to_original = capture.to_original;
  set_up(capture, parts);
  if (report.depth_prior) {
    parts.priors.depth = PriorJson{kSensorDepth, "", {}};
    parts.priors.depth_scale = DepthScale::kScene;
  }
  set_truth_mesh(capture, parts);
  writer.write(parts);
  try {
    check_as_training_does(writer.folder(), parts.split, report);
  } catch (const Error& error) {  // about a folder that is gone when somebody reads the message
    Error::Details details = error.details();
    if (lies_within(details.path, writer.folder())) details.path = capture.folder;
    throw Error(details);
  }
  require_enough_frames();
  writer.commit();
  report.train = parts.split.train->size();
  report.test = parts.split.test->size();
  return report;
}

}  // namespace aligngs
