// Parts of meshes that count in a comparison: what cameras see, and where the true surface is.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "metrics/camera_hits.h"
#include "metrics/mesh_distance.h"
#include "metrics/mesh_protocols.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// The cameras at the resolution at which surfaces are looked at.
std::vector<Camera> ray_cameras(const std::vector<Camera>& cameras, int columns);

/// Truth culled to first hits, and per camera the pixels where it is hit.
struct TruthView {
  TriangleMesh culled;
  std::vector<Camera> cameras;      ///< at ray resolution
  std::vector<Image<uint8_t>> hit;  ///< one per camera, 1 where the truth is hit
};

/// `hits`: those of `truth`; `chosen`: of the cameras that `hits` knows, which are `cameras`.
TruthView look_at_truth(const TriangleMesh& truth, HitCache& hits, const std::vector<Camera>& cameras,
                        const std::vector<size_t>& chosen);

/// Per triangle: all of it lies in the box of `points`, scaled about its centre.
std::vector<uint8_t> triangles_in_box(const TriangleMesh& mesh, const std::vector<Vec3f>& points, double scale);

/// Points in at least one frustum, and on no pixel, of any view, where the truth has no surface.
std::vector<Vec3f> points_where_truth_is(const std::vector<Vec3f>& points, const TruthView& truth, ThreadPool& pool);

struct VisibilityTest {
  const std::vector<Camera>& cameras;
  const TruthView* truth;  ///< samples where it is mostly missing are dropped; null: none
  const MeshProtocolOptions& options;
  /// per sample 0 where no camera of a set that has these cameras sees it; null: not known
  const std::vector<uint8_t>* seen_by_more = nullptr;
};

struct VisibleSamples {
  PointSet points;
  double area = 0;      ///< of the surface with these samples, square units
  bool capped = false;  ///< fewer samples than the density asks for (SurfaceSamples)
  std::vector<uint8_t>
      seen;  ///< per sample of the surface 1 where some camera sees it, also where the truth is missing
};

/// Samples of a mesh, with its rays, that some camera sees.
VisibleSamples visible_samples(const SurfaceSamples& samples, const RayScene& rays, const VisibilityTest& test,
                               ThreadPool& pool);

}  // namespace aligngs
