// Unfolding a mesh: nearly flat charts on one picture, none over another.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/triangle_mesh.h"

namespace aligngs {

struct AtlasSettings {
  int size = 4096;  ///< texels, side of the picture at most
  /// units of the mesh, > 0: edge of a texel at least; larger where the charts would not fit
  double texel = 0;
  /// least cosine between a triangle's normal and its chart's: 60 degrees, so that none shrinks by more than half
  double flat_cosine = 0.5;
  double smooth_cosine = 0.75;  ///< the same of normals averaged over neighbours: 41 degrees
  int gutter = 2;               ///< texels around a chart that belong to it
};

/// A piece of one part that is projected along its mean normal.
struct Chart {
  std::vector<uint32_t> triangles;
  Vec3d normal;               ///< unit
  int x = 0, y = 0;           ///< texels, corner of its rectangle
  int width = 0, height = 0;  ///< texels, with the gutter
};

struct Atlas {
  int width = 0, height = 0;  ///< texels
  double texel = 0;           ///< units of the mesh: edge of a texel
  std::vector<Chart> charts;
  /// per triangle: texels from the top left, centres at + 0.5
  std::vector<std::array<std::array<float, 2>, 3>> corners;
  std::vector<uint32_t> chart_of;  ///< per triangle
};

/// `part`, per triangle: a chart has triangles of one part alone. Charts do not overlap, and no chart covers a texel
/// twice.
/// The same mesh gives the same atlas. Error{kFailed} when the charts fit at no size of texels.
Atlas make_atlas(const TriangleMesh& mesh, const std::vector<uint32_t>& part, const AtlasSettings& settings);

}  // namespace aligngs
