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

void require_input(const MeshEvaluationInput& input) {
  if (!input.predicted || !input.truth || input.truth->empty()) {
    throw_bad_input({}, "truth mesh", "there is no true surface to compare with", "put one at truth/mesh.ply");
  }
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

std::vector<Camera> culling_cameras(const MeshEvaluationInput& input, CullingViews culling, size_t max_cameras) {
  std::vector<Camera> cameras;
  if (culling == CullingViews::kAll) {
    cameras = input.truth_cameras;
  } else {
    for (const int i : input.train) cameras.push_back(input.truth_cameras[i]);
  }
  if (max_cameras == 0 || cameras.size() <= max_cameras) return cameras;
  std::vector<Camera> strided;
  for (size_t i = 0; i < max_cameras; ++i) strided.push_back(cameras[i * cameras.size() / max_cameras]);
  return strided;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) area += triangle_area(mesh, t);
  return area;
}

std::string name_of(MeshAlignment alignment) {
  switch (alignment) {
    case MeshAlignment::kNone:
      return "none";
    case MeshAlignment::kCameras:
      return "cameras";
    case MeshAlignment::kCamerasAndIcp:
      return "cameras+icp";
    case MeshAlignment::kIcp:
      return "icp";
  }
  return "none";
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
  explicit Surface(TriangleMesh m) : mesh(std::move(m)), rays(mesh) {}
  TriangleMesh mesh;
  RayScene rays;
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
    MeshProtocolResult result = named("neuris_vertices", culling, alignment);
    const TruthView& truth = truth_seen_by(culling);
    const Surface& predicted = prediction(truth, alignment, result.alignment_report);
    const std::vector<uint8_t> inside = triangles_in_box(predicted.mesh, truth.culled.vertices, kBoxScale);
    const TriangleMesh mesh =
        keep_triangles(predicted.mesh, first_hit_triangles(predicted.rays, inside, truth.cameras, pool_));
    const std::vector<Vec3f> vertices = points_where_truth_is(mesh.vertices, truth, pool_);
    result.truth_area = area_of(truth.culled);
    result.scores = compare_points({thin_to_voxels(vertices, options_.voxel), {}},
                                   {thin_to_voxels(truth.culled.vertices, options_.voxel), {}}, pool_,
                                   {options_.threshold, true, options_.finer_thresholds});
    return result;
  }

  MeshProtocolResult area_samples(CullingViews culling, MeshAlignment alignment) {
    MeshProtocolResult result = named("area_samples", culling, alignment);
    const std::vector<Camera> cameras = culling_cameras(input_, culling, options_.max_cameras);
    const TruthView& seen = truth_seen_by(culling);
    Surface& mesh = prediction(seen, alignment, result.alignment_report);
    const VisibleSamples predicted =
        visible_samples(mesh.sampled(options_), mesh.rays, {cameras, &seen, options_}, pool_);
    const VisibleSamples expected =
        visible_samples(truth().sampled(options_), truth().rays, {cameras, nullptr, options_}, pool_);
    result.capped = predicted.capped || expected.capped;
    result.predicted_area = predicted.area;
    result.truth_area = expected.area;
    result.scores = compare_points(predicted.points, expected.points, pool_,
                                   {options_.threshold, false, options_.finer_thresholds});
    return result;
  }

  SurfaceQuality surface(MeshAlignment alignment) {
    AlignmentReport report;
    const Surface& predicted = prediction(truth_seen_by(CullingViews::kAll), alignment, report);
    SurfaceQualityInput input;
    input.predicted = &predicted.mesh;
    input.truth = &truth().mesh;
    input.predicted_rays = &predicted.rays;
    input.truth_rays = &truth().rays;
    input.cameras = culling_cameras(input_, CullingViews::kAll, options_.max_cameras);
    input.training = culling_cameras(input_, CullingViews::kTraining, options_.max_cameras);
    input.structural = input_.structural;
    return measure_surface(input, pool_);
  }

 private:
  static MeshProtocolResult named(const char* protocol, CullingViews culling, MeshAlignment alignment) {
    MeshProtocolResult result;
    result.protocol = protocol;
    result.culling = culling == CullingViews::kAll ? "all poses" : "training poses";
    result.alignment = name_of(alignment);
    return result;
  }

  const TruthView& truth_seen_by(CullingViews culling) {
    std::optional<TruthView>& view = culling == CullingViews::kAll ? by_all_ : by_training_;
    if (!view) {
      view = look_at_truth(truth().mesh, truth().rays, culling_cameras(input_, culling, options_.max_cameras), pool_,
                           options_);
    }
    return *view;
  }

  Surface& truth() {
    if (!truth_) truth_.emplace(*input_.truth);
    return *truth_;
  }

  /// `culled` is what ICP aligns to.
  void align(MeshAlignment alignment, const TriangleMesh& culled) {
    report_ = {};
    predicted_.emplace(aligned_prediction(input_, alignment, culled, pool_, options_, report_));
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

TriangleMesh cull_to_first_hits(const TriangleMesh& mesh, const std::vector<Camera>& cameras, ThreadPool& pool,
                                const MeshProtocolOptions& options) {
  const RayScene rays(mesh);
  return keep_triangles(mesh, first_hit_triangles(rays, std::vector<uint8_t>(mesh.triangles.size(), 1),
                                                  ray_cameras(cameras, options.ray_columns), pool));
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
  if (metric_scene) variants.push_back(evaluator.neuris_vertices(CullingViews::kAll, MeshAlignment::kCameras));
  if (with_icp) {
    variants.push_back(evaluator.neuris_vertices(CullingViews::kAll, icp));
    variants.push_back(evaluator.area_samples(CullingViews::kAll, icp));
  }
  return evaluation;
}

}  // namespace aligngs
