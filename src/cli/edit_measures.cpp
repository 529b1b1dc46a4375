#include "cli/edit_measures.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/print_json.h"
#include "core/error.h"
#include "edit/mesh_selection.h"
#include "edit/object_scores.h"
#include "edit/removal_score.h"
#include "edit/selection_truth.h"
#include "scene/mesh_ply.h"
#include "scene/segment_file.h"
#include "train/opened_run.h"
#include "train/voted_objects.h"

namespace aligngs {

using Json = nlohmann::json;

namespace {

/// The room with the objects that --objects asks for.
EditableRoom with_objects(EditSession& session, const EditOptions& options) {
  EditableRoom room = session.room();
  if (options.objects == "stored") return room;
  const SharedRun run = open_run_as_trained(options.run, options.scene);
  TrainConfig config = run->config;
  config.semantic.object_votes = options.objects == "votes";
  if (config.semantic.object_votes && !has_segments(run->scene)) {
    throw_bad_input(run->scene.folder / "segments", "", "not every training photo has segments, so that none votes",
                    "make them: aligngs priors SCENE --semantics eomt-panoptic");
  }
  number_objects(room.gaussians.model, run->scene, config, room.gaussians.labels, session.pool());
  return room;
}

/// Every object of a synthetic room.
void measure_objects(const CommandContext& context, EditSession& session, const EditOptions& options) {
  const TriangleMesh truth = read_mesh_ply(session.scene().truth_mesh);
  const std::filesystem::path list = session.scene().truth_mesh.parent_path() / "objects.json";
  ObjectDetection detection;
  const std::vector<ObjectScore> scores =
      score_objects(with_objects(session, options), truth, read_true_objects(list, truth.vertices.size()),
                    session.pool(), {}, &detection);
  Json objects = Json::array();
  std::string text;
  double sum = 0;
  for (const ObjectScore& s : scores) {
    objects.push_back({{"object", s.object}, {"selection", s.selection}, {"iou", s.iou}, {"area", s.area}});
    char line[200];
    std::snprintf(line, sizeof line, "%-24s IoU %.3f  %7.3f m2  %s\n", s.object.c_str(), s.iou, s.area,
                  s.selection.empty() ? "no selection touches it" : s.selection.c_str());
    text += line;
    sum += s.iou;
  }
  const double mean = scores.empty() ? 0 : sum / static_cast<double>(scores.size());
  char line[300];
  std::snprintf(line, sizeof line,
                "%-24s IoU %.3f  of %zu objects\n"
                "found one by one: %zu of %zu true objects by %zu objects at IoU 0.5 (precision %.3f, recall %.3f, F "
                "%.3f)\n",
                "mean", mean, scores.size(), detection.right, detection.truths, detection.found, detection.precision(),
                detection.recall(), detection.fscore());
  print_result(context,
               Json{{"objects", objects},
                    {"mean_iou", mean},
                    {"detection",
                     {{"iou", 0.5},
                      {"truths", detection.truths},
                      {"found", detection.found},
                      {"right", detection.right},
                      {"precision", detection.precision()},
                      {"recall", detection.recall()},
                      {"fscore", detection.fscore()}}}},
               text + line);
}

}  // namespace

void measure_selection(const CommandContext& context, EditSession& session, const EditOptions& options) {
  const EditableRoom& room = session.room();
  if (session.scene().truth_mesh.empty()) {
    throw_bad_input(session.scene().folder / "truth", "mesh.ply", "the scene has no true mesh to measure against",
                    "use a synthetic room, or leave out --measure");
  }
  if (room.mesh.vertices.empty()) {
    throw_bad_input(session.folder() / "mesh", "mesh.ply", "the run has no mesh", "make it first: aligngs mesh RUN");
  }
  if (options.select.empty()) return measure_objects(context, session, options);
  const SelectionQuery query = read_selection(room, options.select);
  const GaussianSelection selection =
      select_gaussians(room.gaussians, query, parse_threshold(options.threshold), room.labels, {}, session.pool());
  std::vector<Camera> cameras;
  for (const int view : session.scene().train)
    cameras.push_back(session.scene().evaluation_cameras[static_cast<size_t>(view)]);
  const SelectionScore s = score_selection(
      room.mesh,
      select_vertices(room.mesh, room.gaussians.model, selection.mask, room.gaussians.extent, session.pool()),
      read_mesh_ply(session.scene().truth_mesh), query, cameras, session.pool());
  char text[400];
  std::snprintf(text, sizeof text,
                "selected     %zu Gaussians, %.3f m2 of mesh; visible true surface %.3f m2\n"
                "labels       IoU %.3f over the reconstructed surface, which measures the selection\n"
                "surface      IoU %.3f at 5 cm (precision %.3f, recall %.3f), which measures selection and geometry\n",
                selection.count, s.selected_area, s.true_area, s.label_iou, s.iou, s.precision, s.recall);
  print_result(context,
               Json{{"selection", selection_text(query, room.labels)},
                    {"gaussians", selection.count},
                    {"label_iou", s.label_iou},
                    {"surface_iou", s.iou},
                    {"precision", s.precision},
                    {"recall", s.recall},
                    {"selected_area", s.selected_area},
                    {"true_area", s.true_area}},
               text);
}

void measure_removal(const CommandContext& context, const EditOptions& options) {
  const OpenedRun run = open_run(options.run, options.scene);
  ThreadPool pool(context.global.threads);
  const std::filesystem::path mesh_file = run.folder / "mesh" / "mesh.ply";
  std::vector<Camera> cameras;
  for (const int view : run.scene.train) cameras.push_back(run.scene.evaluation_cameras[static_cast<size_t>(view)]);
  const RemovalScore s =
      score_removal(run.folder / "renders" / "test" / "rgb", options.truth,
                    std::filesystem::exists(mesh_file) ? read_mesh_ply(mesh_file) : TriangleMesh(), cameras, pool);
  char text[300];
  std::snprintf(text, sizeof text,
                "PSNR %.2f dB and SSIM %.3f where %zu test views show the object\n"
                "F %.3f at 5 cm (precision %.3f, recall %.3f) in the object's box\n",
                s.psnr, s.ssim, s.views, s.fscore, s.precision, s.recall);
  print_result(context,
               Json{{"truth", options.truth},
                    {"views", s.views},
                    {"psnr", s.psnr},
                    {"ssim", s.ssim},
                    {"precision", s.precision},
                    {"recall", s.recall},
                    {"fscore", s.fscore}},
               text);
}

}  // namespace aligngs
