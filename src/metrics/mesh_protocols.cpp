#include "metrics/mesh_protocols.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "metrics/mesh_culling.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

constexpr double kBoxScale = 1.1;  // NeuRIS: truth box about its centre

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) area += triangle_area(mesh, t);
  return area;
}

void require_input(const MeshEvaluationInput& input) {
  if (!input.predicted || !input.truth || input.truth->empty()) {
    throw_bad_input({}, "truth mesh", "there is no true surface to compare with", "put one at truth/mesh.ply");
  }
  if (!(area_of(*input.truth) > 0)) throw_bad_input({}, "truth mesh", "its triangles have no area", "give a surface");
  if (input.truth_cameras.empty() || input.run_cameras.size() != input.truth_cameras.size()) {
    throw_bad_input(
        {}, "cameras",
        fmt::format("{} cameras of the run and {} true cameras", input.run_cameras.size(), input.truth_cameras.size()),
        "give the same views to both, at least one");
  }
  for (const int i : input.train) {
    if (i < 0 || size_t(i) >= input.truth_cameras.size()) {
      throw_bad_input({}, "training views", fmt::format("view {} does not exist", i));
    }
  }
}

/// Places in input.truth_cameras.
std::vector<size_t> culling_views(const MeshEvaluationInput& input, CullingViews culling, size_t max_cameras) {
  std::vector<size_t> views;
  if (culling == CullingViews::kAll) {
    for (size_t i = 0; i < input.truth_cameras.size(); ++i) views.push_back(i);
  } else {
    for (const int i : input.train) views.push_back(static_cast<size_t>(i));
  }
  if (max_cameras == 0 || views.size() <= max_cameras) return views;
  std::vector<size_t> strided;
  for (size_t i = 0; i < max_cameras; ++i) strided.push_back(views[i * views.size() / max_cameras]);
  return strided;
}

/// The predicted mesh in the world of the truth. ICP runs against area samples of the culled truth.
TriangleMesh aligned_prediction(const MeshEvaluationInput& input, MeshAlignment alignment, const TriangleMesh& culled,
                                ThreadPool& pool, const MeshProtocolOptions& options, AlignmentReport& report) {
  TriangleMesh mesh = *input.predicted;
  if (alignment == MeshAlignment::kCameras || alignment == MeshAlignment::kCamerasAndIcp) {
    const SimilarityFit fit = align_on_training_cameras(input);
    report.similarity = fit.similarity;
    report.camera_rmse = fit.rmse;
    report.cameras_well_posed = fit.well_posed;
    mesh = transformed(mesh, fit.similarity);
  }
  if (alignment == MeshAlignment::kIcp || alignment == MeshAlignment::kCamerasAndIcp) {
    const SurfaceSamples target = sample_surface(culled, {options.points_per_area, options.max_points, options.seed});
    const IcpReport icp = align_by_icp(thin_to_voxels(mesh.vertices, options.voxel), {target.positions, target.normals},
                                       pool, options.icp);
    mesh = transformed(mesh, icp.similarity);
    Similarity& s = report.similarity;
    s = {icp.similarity.scale * s.scale, icp.similarity.rotation * s.rotation, icp.similarity * s.translation};
    report.icp = icp;
  }
  return mesh;
}

/// A mesh with what every protocol asks of it; made one after the other, a mesh of a million triangles takes seconds.
struct Surface {
  Surface(TriangleMesh m, const std::vector<Camera>& ray_cameras, ThreadPool& pool)
      : mesh(std::move(m)), rays(mesh), hits(rays, mesh.triangles.size(), ray_cameras, pool) {}
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  TriangleMesh mesh;
  RayScene rays;
  HitCache hits;
  std::vector<uint8_t> seen;  // of the samples, by all cameras (VisibleSamples); empty: not known
  std::optional<SurfaceSamples> samples;
  const SurfaceSamples& sampled(const MeshProtocolOptions& options) {
    if (!samples) samples = sample_surface(mesh, {options.points_per_area, options.max_points, options.seed});
    return *samples;
  }
};

/// Runs protocols on one pair of meshes and remembers what it made of either.
class Evaluator {
 public:
  Evaluator(const MeshEvaluationInput& input, const MeshProtocolOptions& options, ThreadPool& pool)
      : input_(input), options_(options), pool_(pool) {
    require_input(input);
    ray_cameras_ = ray_cameras(input.truth_cameras, options.ray_columns);
  }

  /// For protocols without ICP: a tree is built by one thread, so that it is always the same, but two trees can be at
  /// once.
  void prepare(MeshAlignment alignment) {
    pool_.parallel_for(2, 1, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        if (i == 0)
          truth();
        else
          align(alignment, {});
      }
    });
  }

  MeshProtocolResult neuris_vertices(CullingViews culling, MeshAlignment alignment) {
    MeshProtocolResult result = named(MeshProtocol::kNeurisVertices, culling, alignment);
    const TruthView& truth = truth_seen_by(culling);
    Surface& predicted = prediction(truth, alignment, result.alignment_report);
    const std::vector<uint8_t> inside = triangles_in_box(predicted.mesh, truth.culled.vertices, kBoxScale);
    const TriangleMesh mesh = keep_triangles(predicted.mesh, predicted.hits.seen(views(culling), inside));
    const std::vector<Vec3f> vertices = points_where_truth_is(mesh.vertices, truth, pool_);
    result.truth_area = area_of(truth.culled);
    result.scores = compare_points({thin_to_voxels(vertices, options_.voxel), {}},
                                   {thin_to_voxels(truth.culled.vertices, options_.voxel), {}}, pool_,
                                   {options_.threshold, true, options_.finer_thresholds});
    return result;
  }

  MeshProtocolResult area_samples(CullingViews culling, MeshAlignment alignment) {
    MeshProtocolResult result = named(MeshProtocol::kAreaSamples, culling, alignment);
    const std::vector<Camera> cameras = culling_cameras(culling);
    const TruthView& seen = truth_seen_by(culling);
    Surface& mesh = prediction(seen, alignment, result.alignment_report);
    const VisibleSamples predicted = visible_part(mesh, {cameras, &seen, options_}, culling);
    const VisibleSamples expected = visible_part(truth(), {cameras, nullptr, options_}, culling);
    result.capped = predicted.capped || expected.capped;
    result.predicted_area = predicted.area;
    result.truth_area = expected.area;
    result.scores = compare_points(predicted.points, expected.points, pool_,
                                   {options_.threshold, false, options_.finer_thresholds});
    return result;
  }

  SurfaceQuality surface(MeshAlignment alignment) {
    AlignmentReport report;
    Surface& predicted = prediction(truth_seen_by(CullingViews::kAll), alignment, report);
    const std::vector<uint8_t> all(predicted.mesh.triangles.size(), 1);
    SurfaceQualityInput input;
    input.predicted = &predicted.mesh;
    input.truth = &truth().mesh;
    input.predicted_rays = &predicted.rays;
    input.truth_rays = &truth().rays;
    input.seen = predicted.hits.seen(views(CullingViews::kAll), all);
    input.training = culling_cameras(CullingViews::kTraining);
    input.structural = input_.structural;
    return measure_surface(input, pool_);
  }

  /// Through all cameras, however many there are.
  TriangleMesh truth_seen() {
    const std::vector<uint8_t> all(truth().mesh.triangles.size(), 1);
    return keep_triangles(truth().mesh, truth().hits.seen(culling_views(input_, CullingViews::kAll, 0), all));
  }

 private:
  std::vector<size_t> views(CullingViews culling) const { return culling_views(input_, culling, options_.max_cameras); }
  std::vector<Camera> culling_cameras(CullingViews culling) const {
    std::vector<Camera> cameras;
    for (const size_t v : views(culling)) cameras.push_back(input_.truth_cameras[v]);
    return cameras;
  }

  static MeshProtocolResult named(MeshProtocol protocol, CullingViews culling, MeshAlignment alignment) {
    MeshProtocolResult result;
    result.protocol = protocol;
    result.culling = culling;
    result.alignment = alignment;
    return result;
  }

  /// Training cameras see no sample that not one of all cameras sees: those samples need no rays again.
  VisibleSamples visible_part(Surface& surface, VisibilityTest test, CullingViews culling) {
    const bool strided = options_.max_cameras > 0 && input_.truth_cameras.size() > options_.max_cameras;
    if (culling == CullingViews::kTraining && !strided && !surface.seen.empty()) test.seen_by_more = &surface.seen;
    VisibleSamples visible = visible_samples(surface.sampled(options_), surface.rays, test, pool_);
    if (culling == CullingViews::kAll) surface.seen = std::move(visible.seen);
    return visible;
  }

  const TruthView& truth_seen_by(CullingViews culling) {
    std::optional<TruthView>& view = culling == CullingViews::kAll ? by_all_ : by_training_;
    if (!view) {
      view = look_at_truth(truth().mesh, truth().hits, ray_cameras_, views(culling));
    }
    return *view;
  }

  Surface& truth() {
    if (!truth_) truth_.emplace(*input_.truth, ray_cameras_, pool_);
    return *truth_;
  }

  /// `culled` is what ICP aligns to.
  void align(MeshAlignment alignment, const TriangleMesh& culled) {
    report_ = {};
    predicted_.emplace(aligned_prediction(input_, alignment, culled, pool_, options_, report_), ray_cameras_, pool_);
    alignment_ = alignment;
  }

  /// The predicted mesh aligned as asked. Valid until the next call.
  Surface& prediction(const TruthView& truth, MeshAlignment alignment, AlignmentReport& report) {
    const bool icp = alignment == MeshAlignment::kIcp || alignment == MeshAlignment::kCamerasAndIcp;
    if (!predicted_ || icp || alignment_ != alignment) align(alignment, truth.culled);
    report = report_;
    return *predicted_;
  }

  const MeshEvaluationInput& input_;
  const MeshProtocolOptions& options_;
  ThreadPool& pool_;
  std::vector<Camera> ray_cameras_;  // all true cameras, at the resolution of the rays
  std::optional<Surface> truth_, predicted_;
  MeshAlignment alignment_ = MeshAlignment::kNone;  // of predicted_
  AlignmentReport report_;
  std::optional<TruthView> by_all_, by_training_;
};

}  // namespace

SimilarityFit align_on_training_cameras(const MeshEvaluationInput& input) {
  std::vector<Rigidd> run, truth;
  for (const int i : input.train) {
    run.push_back(input.run_cameras[i].world_to_camera);
    truth.push_back(input.truth_cameras[i].world_to_camera);
  }
  return fit_similarity_of_cameras(run, truth);
}

TriangleMesh transformed(const TriangleMesh& mesh, const Similarity& similarity) {
  TriangleMesh moved = mesh;
  for (Vec3f& v : moved.vertices) v = (similarity * v.cast<double>()).cast<float>();
  for (Vec3f& n : moved.normals) n = (similarity.rotation * n.cast<double>()).cast<float>();
  return moved;
}

MeshProtocolResult evaluate_neuris_vertices(const MeshEvaluationInput& input, CullingViews culling,
                                            MeshAlignment alignment, ThreadPool& pool,
                                            const MeshProtocolOptions& options) {
  return Evaluator(input, options, pool).neuris_vertices(culling, alignment);
}

MeshProtocolResult evaluate_area_samples(const MeshEvaluationInput& input, CullingViews culling,
                                         MeshAlignment alignment, ThreadPool& pool,
                                         const MeshProtocolOptions& options) {
  return Evaluator(input, options, pool).area_samples(culling, alignment);
}

MeshEvaluation evaluate_mesh(const MeshEvaluationInput& input, bool metric_scene, bool with_icp, ThreadPool& pool,
                             const MeshProtocolOptions& options) {
  const MeshAlignment alignment = metric_scene ? MeshAlignment::kNone : MeshAlignment::kCameras;
  const MeshAlignment icp = metric_scene ? MeshAlignment::kIcp : MeshAlignment::kCamerasAndIcp;
  Evaluator evaluator(input, options, pool);
  evaluator.prepare(alignment);
  MeshEvaluation evaluation;
  evaluation.headline = evaluator.neuris_vertices(CullingViews::kAll, alignment);
  evaluation.surface = evaluator.surface(alignment);
  auto& variants = evaluation.variants;
  variants.push_back(evaluator.area_samples(CullingViews::kAll, alignment));
  variants.push_back(evaluator.neuris_vertices(CullingViews::kTraining, alignment));
  variants.push_back(evaluator.area_samples(CullingViews::kTraining, alignment));
  evaluation.truth_seen = evaluator.truth_seen();
  if (metric_scene) variants.push_back(evaluator.neuris_vertices(CullingViews::kAll, MeshAlignment::kCameras));
  if (with_icp) {
    variants.push_back(evaluator.neuris_vertices(CullingViews::kAll, icp));
    variants.push_back(evaluator.area_samples(CullingViews::kAll, icp));
  }
  return evaluation;
}

}  // namespace aligngs
