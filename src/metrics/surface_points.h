// Points that represent a surface: area-uniform samples, vertices, and their thinning to one per voxel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/triangle_mesh.h"

namespace aligngs {

/// Surface points with the unit normal of their triangle.
struct SurfaceSamples {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<uint32_t> triangles;  ///< on which each lies
  double area = 0;                  ///< of the whole mesh, squared units
  bool capped = false;              ///< fewer points than the density asks for, because of the cap
};

struct SamplingOptions {
  double points_per_area = 1e4;   ///< per square unit: 1 per cm^2 when units are metres (GO-Surf)
  size_t max_points = 4'000'000;  ///< cap: 400 m^2 at that density, about 100 MB
  uint64_t seed = 1;
};

/// Area-uniform random points, stratified along the running sum of areas. Triangles that are degenerate or not finite
/// get none. The same mesh and seed give the same points.
SurfaceSamples sample_surface(const TriangleMesh& mesh, const SamplingOptions& options = {});

/// One point per occupied voxel: the mean of the points in it, in order of first appearance. The grid starts half a
/// voxel below the smallest coordinates, as Open3D's voxel_down_sample does. Non-finite points are dropped.
/// Error{kUsage} when voxel <= 0 or when the points span more than 2^21 voxels.
std::vector<Vec3f> thin_to_voxels(const std::vector<Vec3f>& points, double voxel);

struct LabelledPoints {
  std::vector<Vec3f> positions;
  std::vector<uint16_t> labels;
};
/// The same for labelled points; points of kNoLabel are dropped first. A voxel has its majority label, the smaller of
/// two equally frequent ones.
LabelledPoints thin_labelled(const std::vector<Vec3f>& points, const std::vector<uint16_t>& labels, double voxel);

/// Area of a triangle of the mesh in squared units, 0 when it is not finite.
double triangle_area(const TriangleMesh& mesh, size_t triangle);

}  // namespace aligngs
