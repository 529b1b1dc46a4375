// New Gaussians and new mesh for the cells of a plane.
#pragma once

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

/// Fills the cells marked in `hole` from the carriers: rows of Gaussians that lie on the plane and are of the surface
/// that continues. Their constant harmonics are continued smoothly (surface_colors.h); the others are the carriers'
/// mean. Without carriers the patch is empty.
SupportPatch make_patch(const LabelledGaussians& room, const PlaneGrid& grid, const std::vector<uint8_t>& hole,
                        const std::vector<uint32_t>& carriers);

/// `more` after `patch`.
void append_patch(SupportPatch& patch, const SupportPatch& more);

}  // namespace aligngs
