#include "cli/stages/eval_stage.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "cli/stages/perceptual_metric.h"
#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "metrics/image_metrics.h"
#include "metrics/mesh_protocols.h"
#include "metrics/metrics_json.h"
#include "metrics/semantic_metrics.h"
#include "metrics/view_novelty.h"
#include "refine/photo_alignment.h"
#include "scene/mesh_ply.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr double kMetresPerExtent = 3;  // extent of a room of 4 to 5 m, for scenes without metres

/// True cameras decide where the photos were taken, if there are any.
std::vector<Camera> true_training_cameras(const Scene& scene) {
  std::vector<Camera> cameras;
  for (const int view : scene.train) cameras.push_back(scene.evaluation_cameras[static_cast<size_t>(view)]);
  return cameras;
}

/// The cameras of the run and the true ones, without meshes yet.
MeshEvaluationInput evaluation_cameras_of(const Scene& scene) {
  MeshEvaluationInput input;
  for (const View& view : scene.views) input.run_cameras.push_back(view.camera);
  input.truth_cameras = scene.evaluation_cameras;
  input.train = scene.train;
  return input;
}

PoseError pose_error(const Camera& camera, const Camera& truth, const Similarity& to_truth) {
  const Rigidd moved = to_truth.transform_world_to_camera(camera.world_to_camera);
  return {norm(to_truth * camera.centre() - truth.centre()),
          rotation_angle_between_degrees(moved.rotation, truth.world_to_camera.rotation)};
}

/// Scores with the pose fitted to the test photo itself; the scene is frozen. `start`: the scene from data.camera.
RefinedPoseMetrics measure_with_refined_pose(LoadedRun& run, int view, const ViewData& data, SceneLook start,
                                             const Similarity& to_truth) {
  RenderOptions options = run.render_options();
  options.labels = false;
  const LookAtScene look = [&](const Camera& camera) {
    Rendering r = run.engine->render(camera, options);
    run.expose_as(view, r.color);
    return SceneLook{std::move(r.color), std::move(r.depth_plane)};
  };
  const PhotoAlignment aligned = align_to_photo({data.camera, data.color, data.mask, std::move(start)}, look);
  const ImageScores scores = compare_images(aligned.seen.color, data.color, data.mask, {}, run.pool.get());
  RefinedPoseMetrics refined;
  refined.psnr = scores.psnr;
  refined.ssim = scores.ssim;
  refined.shift = norm(aligned.camera.centre() - data.camera.centre());
  refined.turn_degrees =
      rotation_angle_between_degrees(aligned.camera.world_to_camera.rotation, data.camera.world_to_camera.rotation);
  if (const std::optional<Camera>& truth = run.scene().views[static_cast<size_t>(view)].truth_camera) {
    refined.before = pose_error(data.camera, *truth, to_truth);
    refined.after = pose_error(aligned.camera, *truth, to_truth);
  }
  return refined;
}

void measure_views(LoadedRun& run, const EvalStageOptions& options, RunMetrics& metrics) {
  ConfusionMatrix confusion(run.scene().labels.size()), taught(run.scene().labels.size());
  bool labelled = false, judged = false;
  const std::vector<Camera> training = true_training_cameras(run.scene());
  const double metres_per_unit = run.scene().metric ? 1 : kMetresPerExtent / robust_extent(run.scene());
  const PerceptualMetric perceptual(ModelStore(ModelStoreOptions::from_environment(true)), *run.pool);
  Progress progress(options.progress, "evaluate views", run.scene().test.size());
  LoadOptions load = run.load_options();
  load.scores_as_logits = run.config().data.scores_as_logits;
  // the teacher is judged by its best class of every pixel, whatever the run itself makes of its scores
  load.least_score_sum = 0;
  const Similarity to_truth = align_on_training_cameras(evaluation_cameras_of(run.scene())).similarity;
  for (const int index : run.scene().test) {
    const View& view = run.scene().views[index];
    const bool labels = run.has_labels() && !view.truth_labels.empty();
    load.semantics = labels;  // the teacher's own, to be judged beside the rendered ones
    const ViewData data = load_view(run.scene(), index, load);
    Rendering rendering = run.engine->render(data.camera, run.render_options());
    run.expose_as(index, rendering.color);
    const ImageScores scores = compare_images(rendering.color, data.color, data.mask, {}, run.pool.get());
    TestViewMetrics entry;
    entry.name = view.name;
    entry.psnr = scores.psnr;
    entry.ssim = scores.ssim;
    entry.psnr_exposure_fitted = scores.psnr_affine_crossfit;
    const ViewNovelty novelty = view_novelty(run.scene().evaluation_cameras[static_cast<size_t>(index)], training);
    entry.extrapolates = extrapolates(novelty, metres_per_unit);
    if (const auto distances = perceptual.measure(rendering.color, data.color, data.mask)) {
      entry.lpips = distances->canonical;
      entry.lpips_unit = distances->unit;
    }
    if (labels) {
      const Image<uint16_t> truth = load_truth_labels(run.scene(), index, data.camera);
      confusion.add(truth, rendering.label);
      ConfusionMatrix own(run.scene().labels.size());
      own.add(truth, rendering.label);
      entry.label_accuracy = own.scores().accuracy;
      labelled = true;
      if (!data.labels.empty()) taught.add(truth, data.labels);
      judged |= !data.labels.empty();
    }
    if (options.refine_test_poses) {
      SceneLook seen{std::move(rendering.color), std::move(rendering.depth_plane)};
      entry.pose_refined = measure_with_refined_pose(run, index, data, std::move(seen), to_truth);
    }
    metrics.views.push_back(std::move(entry));
    progress.update(metrics.views.size());
  }
  metrics.novel_views =
      novel_view_metrics(metrics.views, perceptual.reason().empty()
                                            ? "VGG16, v0.1; lpips: inputs in [-1, 1], lpips_unit: inputs left in [0, 1]"
                                            : perceptual.reason());
  if (labelled) metrics.semantics = confusion.scores();
  if (judged) metrics.teacher = taught.scores();
}

/// Per class 1 for those that bound a room.
std::vector<uint8_t> structural_classes(const LabelSet& labels) {
  std::vector<uint8_t> structural(static_cast<size_t>(labels.size()), 0);
  for (const char* name : {"wall", "floor", "ceiling"}) {
    if (const int c = labels.find(name); c >= 0) structural[static_cast<size_t>(c)] = 1;
  }
  return structural;
}

/// Geometry and mesh labels against the true mesh; empty when either mesh is missing.
void measure_mesh(LoadedRun& run, const EvalStageOptions& options, RunMetrics& metrics) {
  const fs::path truth_file = options.truth_mesh.empty() ? run.scene().truth_mesh : options.truth_mesh;
  const fs::path mesh_file = options.mesh.empty() ? run.folder() / "mesh" / "mesh.ply" : options.mesh;
  if (truth_file.empty() || !fs::exists(truth_file)) {
    if (!options.mesh.empty()) {
      throw_bad_input(options.mesh, "--mesh", "the scene has no true mesh to measure this mesh against",
                      "give one with --gt-mesh FILE.ply");
    }
    return;
  }
  if (!fs::exists(mesh_file)) {
    log_warning("{} is missing, so geometry is not measured (run `aligngs mesh` first)", mesh_file.string());
    return;
  }
  const TriangleMesh predicted = read_mesh_ply(mesh_file), truth = read_mesh_ply(truth_file);
  const auto require_faces = [](const fs::path& named, const TriangleMesh& mesh) {
    if (!named.empty() && mesh.triangles.empty())
      throw_bad_input(named, "face", "the file has no faces", "give a surface of triangles");
  };
  require_faces(options.mesh, predicted);
  require_faces(options.truth_mesh, truth);
  MeshEvaluationInput input = evaluation_cameras_of(run.scene());
  input.predicted = &predicted;
  input.truth = &truth;
  input.structural = structural_classes(run.scene().labels);
  metrics.geometry = evaluate_mesh(input, run.scene().metric, options.icp, *run.pool);
  const TriangleMesh seen = std::move(metrics.geometry->truth_seen);
  if (predicted.labels.size() == predicted.vertices.size() && truth.labels.size() == truth.vertices.size() &&
      !truth.vertices.empty() && run.has_labels()) {
    const TriangleMesh moved = transformed(predicted, metrics.geometry->headline.alignment_report.similarity);
    metrics.mesh_labels = compare_mesh_labels(moved, seen, run.scene().labels.size(), *run.pool);
  }
}

TrainingMetrics training_metrics(const LoadedRun& run) {
  TrainingMetrics train;
  const RunRecord& record = run.opened->record;
  train.seconds = record.train.seconds;
  train.iterations = static_cast<uint64_t>(record.train.iterations);
  train.gaussians = record.train.gaussians;
  train.iterations_per_second = record.train.iterations_per_second;
  train.peak_memory_bytes = record.train.peak_memory_bytes;
  train.device = record.device;
  return train;
}

}  // namespace

void require_named_meshes(const EvalStageOptions& options) {
  const std::pair<const fs::path*, const char*> named[] = {{&options.truth_mesh, "--gt-mesh"},
                                                           {&options.mesh, "--mesh"}};
  for (const auto& [file, option] : named) {
    if (!file->empty() && !fs::is_regular_file(*file))
      throw_bad_input(*file, option, "there is no such mesh", "check the name, or leave the option out");
  }
}

RunMetrics evaluate_run(LoadedRun& run, const EvalStageOptions& options) {
  require_named_meshes(options);
  RunMetrics metrics;
  metrics.scene_source = run.scene().source;
  metrics.priors = run.scene().prior_source;
  metrics.width = run.working_camera(0).width;
  metrics.height = run.working_camera(0).height;
  metrics.labels = run.scene().labels;
  if (options.views) measure_views(run, options, metrics);
  measure_mesh(run, options, metrics);
  metrics.train = training_metrics(run);
  if (options.mesh.empty()) write_file_atomically(run.folder() / "metrics.json", json_document(metrics_json(metrics)));
  return metrics;
}

}  // namespace aligngs
