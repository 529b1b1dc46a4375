#include "metrics/mesh_protocols.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

constexpr double kBoxScale = 1.1;     // NeuRIS: truth box about its centre
constexpr size_t kPointGrain = 1024;  // points per chunk of visibility tests

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

/// The cameras at the resolution at which surfaces are looked at.
std::vector<Camera> ray_cameras(const std::vector<Camera>& cameras, int columns) {
  std::vector<Camera> resized;
  for (const Camera& c : cameras) {
    const int rows = std::max(1, static_cast<int>(std::lround(double(c.height) * columns / c.width)));
    resized.push_back(c.resized(columns, rows));
  }
  return resized;
}

/// Truth culled to first hits, and per camera the pixels where it is hit.
struct TruthView {
  TriangleMesh culled;
  std::vector<Camera> cameras;  // at ray resolution
  std::vector<Image<uint8_t>> hit;
};

TruthView look_at_truth(const TriangleMesh& truth, const RayScene& rays, const std::vector<Camera>& cameras,
                        ThreadPool& pool, const MeshProtocolOptions& options) {
  TruthView view;
  view.cameras = ray_cameras(cameras, options.ray_columns);
  std::vector<uint8_t> keep(truth.triangles.size(), 0);
  for (const Camera& camera : view.cameras) {
    const FirstHits hits = rays.cast(camera, pool);
    Image<uint8_t> mask(camera.width, camera.height, 1);
    for (size_t i = 0; i < mask.data.size(); ++i) {
      const uint32_t t = hits.triangle.data[i];
      if (t == kNoTriangle) continue;
      keep[t] = 1;
      mask.data[i] = 1;
    }
    view.hit.push_back(std::move(mask));
  }
  view.culled = keep_triangles(truth, keep);
  return view;
}

bool truth_hit_at(const Image<uint8_t>& mask, const Vec2d& uv) {
  return mask.at(static_cast<int>(uv.x), static_cast<int>(uv.y)) != 0;
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

struct Box {
  Vec3d low, high;
  bool contains(const Vec3f& p) const {
    for (int a = 0; a < 3; ++a) {
      if (!(p[a] >= low[a] && p[a] <= high[a])) return false;
    }
    return true;
  }
};

Box scaled_box(const std::vector<Vec3f>& points, double scale) {
  const double inf = std::numeric_limits<double>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Vec3f& p : points) {
    for (int a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], double(p[a]));
      box.high[a] = std::max(box.high[a], double(p[a]));
    }
  }
  for (int a = 0; a < 3; ++a) {
    const double centre = (box.low[a] + box.high[a]) / 2, half = (box.high[a] - box.low[a]) / 2 * scale;
    box.low[a] = centre - half;
    box.high[a] = centre + half;
  }
  return box;
}

/// Per triangle: all of it lies in the box.
std::vector<uint8_t> triangles_in(const Box& box, const TriangleMesh& mesh) {
  std::vector<uint8_t> keep(mesh.triangles.size(), 1);
  for (size_t t = 0; t < keep.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) keep[t] &= box.contains(mesh.vertices[v]);
  }
  return keep;
}

/// In at least one frustum, and on no pixel, of any view, where the truth has no surface.
bool inside_truth_masks(const Vec3f& vertex, const TruthView& view) {
  bool seen = false;
  for (size_t c = 0; c < view.cameras.size(); ++c) {
    const auto uv = project_into_image(view.cameras[c], vertex.cast<double>());
    if (!uv) continue;
    if (!truth_hit_at(view.hit[c], *uv)) return false;
    seen = true;
  }
  return seen;
}

template <class Keep>
std::vector<uint8_t> test_points(const std::vector<Vec3f>& points, ThreadPool& pool, const Keep& keep) {
  std::vector<uint8_t> kept(points.size(), 0);
  pool.parallel_for(points.size(), kPointGrain, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) kept[i] = keep(points[i]);
  });
  return kept;
}

PointSet select(const SurfaceSamples& samples, const std::vector<uint8_t>& keep) {
  PointSet set;
  for (size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    set.positions.push_back(samples.positions[i]);
    set.normals.push_back(samples.normals[i]);
  }
  return set;
}

/// Samples of a mesh that some camera sees; with `truth`, those where the truth is mostly missing are dropped.
PointSet visible_samples(const SurfaceSamples& samples, const RayScene& rays, const std::vector<Camera>& cameras,
                         const TruthView* truth, ThreadPool& pool, const MeshProtocolOptions& options, bool& capped,
                         double& area) {
  std::vector<Vec3d> eyes;
  for (const Camera& c : cameras) eyes.push_back(c.centre());
  const std::vector<uint8_t> keep = test_points(samples.positions, pool, [&](const Vec3f& p) {
    const Vec3d point = p.cast<double>();
    size_t seen = 0, missing = 0;
    for (size_t c = 0; c < cameras.size(); ++c) {
      if (!project_into_image(cameras[c], point)) continue;
      if (!rays.sees(eyes[c], point, options.occlusion_tolerance)) continue;
      if (!truth) return true;
      ++seen;
      const auto uv = project_into_image(truth->cameras[c], point);
      missing += !uv || !truth_hit_at(truth->hit[c], *uv);
    }
    return seen > 0 && static_cast<double>(missing) <= options.max_missing_truth * static_cast<double>(seen);
  });
  capped |= samples.capped;
  PointSet visible = select(samples, keep);
  area = samples.positions.empty() ? 0
                                   : samples.area * static_cast<double>(visible.positions.size()) /
                                         static_cast<double>(samples.positions.size());
  return visible;
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
    const std::vector<uint8_t> inside = triangles_in(scaled_box(truth.culled.vertices, kBoxScale), predicted.mesh);
    const TriangleMesh mesh =
        keep_triangles(predicted.mesh, first_hit_triangles(predicted.rays, inside, truth.cameras, pool_));
    const std::vector<uint8_t> keep =
        test_points(mesh.vertices, pool_, [&](const Vec3f& v) { return inside_truth_masks(v, truth); });
    std::vector<Vec3f> vertices;
    for (size_t i = 0; i < keep.size(); ++i) {
      if (keep[i]) vertices.push_back(mesh.vertices[i]);
    }
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
    const PointSet predicted = visible_samples(mesh.sampled(options_), mesh.rays, cameras, &seen, pool_, options_,
                                               result.capped, result.predicted_area);
    const PointSet expected = visible_samples(truth().sampled(options_), truth().rays, cameras, nullptr, pool_,
                                              options_, result.capped, result.truth_area);
    result.scores = compare_points(predicted, expected, pool_, {options_.threshold, false, options_.finer_thresholds});
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
