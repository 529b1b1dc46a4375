// Mesh evaluation as the field does it: what is culled, what is compared, and how the meshes are aligned.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/choice_words.h"
#include "core/rigid.h"
#include "core/thread_pool.h"
#include "metrics/icp.h"
#include "metrics/mesh_distance.h"
#include "metrics/surface_quality.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// The points that are compared.
enum class MeshProtocol { kNeurisVertices, kAreaSamples };
template <>
inline constexpr std::array<ChoiceWord<MeshProtocol>, 2> kChoiceWords<MeshProtocol> = {
    {{MeshProtocol::kNeurisVertices, "neuris_vertices"}, {MeshProtocol::kAreaSamples, "area_samples"}}};

/// Poses that decide which part of the room is judged.
enum class CullingViews { kTraining, kAll };
template <>
inline constexpr std::array<ChoiceWord<CullingViews>, 2> kChoiceWords<CullingViews> = {
    {{CullingViews::kTraining, "training poses"}, {CullingViews::kAll, "all poses"}}};

/// How the predicted mesh is brought into the world of the truth.
enum class MeshAlignment {
  kNone,           ///< the worlds are the same
  kCameras,        ///< similarity fitted to the training cameras
  kCamerasAndIcp,  ///< then scaled point-to-plane ICP against the culled truth: a diagnostic, it hides scale and bend
  kIcp             ///< ICP alone, from the same world
};
template <>
inline constexpr std::array<ChoiceWord<MeshAlignment>, 4> kChoiceWords<MeshAlignment> = {
    {{MeshAlignment::kNone, "none"},
     {MeshAlignment::kCameras, "cameras"},
     {MeshAlignment::kCamerasAndIcp, "cameras+icp"},
     {MeshAlignment::kIcp, "icp"}}};

struct MeshEvaluationInput {
  const TriangleMesh* predicted = nullptr;  ///< in the world of run_cameras
  const TriangleMesh* truth = nullptr;      ///< metres, in the world of truth_cameras
  std::vector<Camera> run_cameras;          ///< every view as the run knows it
  std::vector<Camera> truth_cameras;        ///< the same views, true poses
  std::vector<int> train;                   ///< indices of the training views
  /// per class of the truth's labels: 1 for walls, floor and ceiling; may be empty
  std::vector<uint8_t> structural;
};

struct MeshProtocolOptions {
  double threshold = 0.05;                              ///< metres
  std::vector<double> finer_thresholds = {0.01, 0.02};  ///< metres: scores beside those at `threshold`
  double voxel = 0.02;                                  ///< metres, thinning of vertices
  int ray_columns = 320;              ///< width of the images through which surfaces are looked at: NeuRIS halves 640
  double points_per_area = 1e4;       ///< per m^2: 1 per cm^2
  size_t max_points = 4'000'000;      ///< cap of the area samples
  double occlusion_tolerance = 0.02;  ///< metres a point may lie behind the first surface (GO-Surf)
  /// A predicted sample is dropped if more than this share of the views that see it see no true surface there. The
  /// truth has holes (windows, screens, black counters), which must not count as errors. 0.7 is GO-Surf's
  /// --remove_missing_depth; 1 switches it off.
  double max_missing_truth = 0.7;
  size_t max_cameras = 300;  ///< evenly strided when there are more (GO-Surf)
  uint64_t seed = 1;         ///< of the area samples
  IcpOptions icp;
};

/// Alignment of the predicted mesh before measuring.
struct AlignmentReport {
  Similarity similarity;   ///< predicted -> truth
  double camera_rmse = 0;  ///< metres, of the camera centres; 0 without camera alignment
  bool cameras_well_posed = true;
  std::optional<IcpReport> icp;
};

struct MeshProtocolResult {
  MeshProtocol protocol = MeshProtocol::kNeurisVertices;
  CullingViews culling = CullingViews::kAll;
  MeshAlignment alignment = MeshAlignment::kNone;
  std::optional<std::string> stated;  ///< the protocol in the words of an older file, instead of these three
  MeshScores scores;
  AlignmentReport alignment_report;
  double truth_area = 0;      ///< m^2 that could be judged
  double predicted_area = 0;  ///< m^2 of the prediction that was judged (area samples only)
  bool capped = false;        ///< the cap on samples made them sparser than asked
};

/// NeuRIS (5168dcc), evaluation/EvalScanNet.py: measured on vertices thinned to one per voxel. The truth keeps the
/// faces that are first hits of some ray. The prediction loses the vertices outside the truth's box scaled by 1.1,
/// those of faces that are no first hit, and those in no frustum. It also loses those that fall, in any view, on a
/// pixel where the truth has no surface. Distance < threshold counts.
MeshProtocolResult evaluate_neuris_vertices(const MeshEvaluationInput& input, CullingViews culling,
                                            MeshAlignment alignment, ThreadPool& pool,
                                            const MeshProtocolOptions& options = {});

/// Area-uniform samples of both meshes, each kept if some view has it in its frustum and not behind another part of its
/// own mesh. After GO-Surf 71bb125, tools/mesh_metrics.py, with exact rays instead of depth maps. Distance <= threshold
/// counts. Does not depend on tessellation.
MeshProtocolResult evaluate_area_samples(const MeshEvaluationInput& input, CullingViews culling,
                                         MeshAlignment alignment, ThreadPool& pool,
                                         const MeshProtocolOptions& options = {});

/// metrics.json: geometry.* is `headline`, geometry.variants[] are the others.
struct MeshEvaluation {
  /// NeuRIS vertices, all poses; aligned on cameras unless the scene is metric: then that is a variant
  MeshProtocolResult headline;
  std::vector<MeshProtocolResult> variants;
  SurfaceQuality surface;   ///< with the alignment of the headline
  TriangleMesh truth_seen;  ///< faces of the truth that are the first hit of some pixel ray of all poses
};
MeshEvaluation evaluate_mesh(const MeshEvaluationInput& input, bool metric_scene, bool with_icp, ThreadPool& pool,
                             const MeshProtocolOptions& options = {});

/// The similarity that takes the run's world to the truth's, from the training cameras.
SimilarityFit align_on_training_cameras(const MeshEvaluationInput& input);

TriangleMesh transformed(const TriangleMesh& mesh, const Similarity& similarity);

}  // namespace aligngs
