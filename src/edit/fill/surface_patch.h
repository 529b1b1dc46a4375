// New Gaussians and new mesh for the cells of a plane.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "edit/fill/plane_grid.h"
#include "edit/selection.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// A patch for a hole.
struct SupportPatch {
  GaussianModel gaussians;        ///< flat, on the plane, coloured and labelled like the surface that they continue
  std::vector<uint32_t> sources;  ///< per new Gaussian: the row it takes its class from
  TriangleMesh mesh;              ///< the same area, one cell wider
};

/// A hole in a surface, before it is filled.
struct SurfaceHole {
  PlaneGrid grid;
  std::vector<uint8_t> cells;      ///< 1 for those of the hole
  std::vector<uint32_t> carriers;  ///< rows that lie on the plane and are of the surface that continues
  bool is_floor = false;           ///< it may have boards, whose directions continue

  bool is_empty() const { return std::find(cells.begin(), cells.end(), uint8_t(1)) == cells.end(); }
};

/// Fills the cells of a hole from the carriers. Their constant harmonics are continued smoothly (surface_colors.h); the
/// others are the carriers' mean. Without carriers the patch is empty.
/// `gains` has a factor of the colour of each row (lifted_shade.h), or is empty.
SupportPatch make_patch(const LabelledGaussians& room, const SurfaceHole& hole, const std::vector<Vec3f>& gains = {});

/// A row of the room with a lifted colour, at the end of a patch.
void add_lifted(const LabelledGaussians& room, uint32_t row, const Vec3f& gain, SupportPatch& patch);

/// `more` after `patch`.
void append_patch(SupportPatch& patch, const SupportPatch& more);

}  // namespace aligngs
