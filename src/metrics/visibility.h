// Visible parts of a triangle mesh, by ray casting (Embree).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// "The ray hits nothing."
inline constexpr uint32_t kNoTriangle = 0xffffffffu;

/// First hits of the rays through the pixel centres of a camera.
struct FirstHits {
  Image<uint32_t> triangle;  ///< H x W, kNoTriangle where nothing is hit
  ImageF depth;              ///< H x W, camera z of the hit; 0 where nothing is hit
};

/// A point of a surface.
struct SurfacePoint {
  Vec3d position;
  uint32_t triangle = kNoTriangle;
  double distance = 0;  ///< from the point that was asked for, units
};

/// A mesh prepared for rays and for searches of the nearest point. Both sides of a triangle are hit. Keeps its own copy
/// of the geometry.
class RayScene {
 public:
  explicit RayScene(const TriangleMesh& mesh);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// `there`, per triangle: rays pass through those marked 0. nullptr: all are there.
  FirstHits cast(const Camera& camera, ThreadPool& pool, const std::vector<uint8_t>* there = nullptr) const;
  /// Whether the segment from `eye` to `point`, shortened by `tolerance` (units) at the point, meets no surface.
  bool sees(const Vec3d& eye, const Vec3d& point, double tolerance) const;
  /// The surface point that is nearest to `point`, if one lies within `reach` (units, > 0). Degenerate triangles count
  /// as the segments or points that they are.
  std::optional<SurfacePoint> nearest(const Vec3d& point, double reach) const;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

/// Image point of a world point that lies in front of the camera and inside its image.
std::optional<Vec2d> project_into_image(const Camera& camera, const Vec3d& point);

/// Whether `sees(c)` holds for one of `count` cameras. `likely` is asked first; it becomes the camera that sees: points
/// that follow each other are mostly seen by the same.
template <class Sees>
bool any_camera_sees(size_t count, size_t& likely, const Sees& sees) {
  for (size_t k = 0; k < count; ++k) {
    const size_t camera = (likely + k) % count;
    if (!sees(camera)) continue;
    likely = camera;
    return true;
  }
  return false;
}

/// Metres: the surface that a point lies on does not hide it.
inline constexpr double kOwnSurface = 0.005;

/// Per point 1 when it lies in the image of some camera and `scene` has nothing between. The last `tolerance` (units)
/// before the point does not count. The same for any number of threads.
std::vector<uint8_t> seen_points(const RayScene& scene, const std::vector<Camera>& cameras,
                                 const std::vector<Vec3f>& points, double tolerance, ThreadPool& pool);

/// The mesh of the triangles marked 1 and the vertices that they use; attributes follow.
TriangleMesh keep_triangles(const TriangleMesh& mesh, const std::vector<uint8_t>& keep);

}  // namespace aligngs
