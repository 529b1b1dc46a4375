// How smooth and how closed a mesh is, measured against the true surface: what distances between points do not show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/visibility.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

struct SurfaceQualityOptions {
  /// Metres. Surface that is farther from the truth is wrong as a whole, which precision says; its normals say nothing.
  double reach = 0.05;
  double points_per_area = 2500;  ///< per m^2, of the predicted surface whose normals are compared: one per 2 x 2 cm
  double rays_per_area = 900;     ///< per m^2, of the true surface whose closedness is tested
  size_t max_points = 1'000'000;  ///< cap of either: 400 m^2 of the former
  size_t max_edges = 60'000;      ///< edges whose angle is measured, evenly strided when there are more
  /// metres: the truth counts as planar where it is within this distance in eight directions,
  double planar_radius = 0.05;
  double planar_distance = 0.002;  ///< metres: to this deviation,
  double planar_degrees = 2;       ///< and its normals to this angle
  /// Metres behind the true surface, along its normal, before which a ray must have met something.
  double pass_depth = 0.05;
  /// Pixels, of images 320 wide, around a point's projection. Within them the truth must belong to one surface: a
  /// contour that is a pixel off is no hole.
  double contour_pixels = 2;
  double min_cosine = 0.17;  ///< of a view to the true surface: 80 degrees; flatter looks decide nothing
  uint64_t seed = 1;
};

/// Degrees; NaN where nothing was measured.
struct AngleSummary {
  double mean = 0, median = 0;
};

struct SurfaceQuality {
  /// between the face normal and that of the nearest true surface point, 0 to 90
  AngleSummary normal_error;
  AngleSummary structure_normal_error;  ///< the same where that point belongs to a structural class
  /// between neighbouring faces where the truth is planar, weighted by edge length, 0 to 180
  AngleSummary roughness;
  /// share in [0, 1] of the seen true surface that rays of the training views pass through
  double pinholes = 0;
  double structure_pinholes = 0;  ///< of the structural classes
  double truth_seen = 0;          ///< m^2 of true surface that `pinholes` speaks of
  size_t normals = 0, edges = 0;  ///< samples of the angles
};

struct SurfaceQualityInput {
  const TriangleMesh* predicted = nullptr;   ///< in the world of the truth
  const TriangleMesh* truth = nullptr;       ///< metres; its labels, where it has them, name the classes
  const RayScene* predicted_rays = nullptr;  ///< the same meshes, prepared for rays
  const RayScene* truth_rays = nullptr;
  std::vector<uint8_t> seen;     ///< per predicted triangle 1 where it is the first hit of a view's ray: it is judged
  std::vector<Camera> training;  ///< true poses of the training views: their rays look for pinholes
  std::vector<uint8_t> structural;  ///< per class 1 for walls, floor and ceiling; empty: no such figures (NaN)
};

/// Normal error: area-uniform samples of the predicted faces that are first hits of some ray of `cameras` (320
/// columns). Each is compared with the nearest point of the true mesh within `reach`; the sign of normals does not
/// count. Roughness: edges of those faces whose midpoint is within `reach` of planar truth. Both depend on how a surface
/// is cut into triangles: small faces lie between rays, and edges inside a flat part count as 0. Pinholes: area-uniform
/// samples of the true surface, averaged over those that some view sees. The value is the share of views whose ray
/// meets no predicted surface up to `pass_depth` behind the sample. Views are training views that see it away from
/// contours. An empty prediction has no angles (NaN) and pinholes of 1.
SurfaceQuality measure_surface(const SurfaceQualityInput& input, ThreadPool& pool,
                               const SurfaceQualityOptions& options = {});

}  // namespace aligngs
