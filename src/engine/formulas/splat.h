// A projected Gaussian as blending reads it, in whitened form.
#pragma once

#include <cstdint>

#include "core/host_device.h"
#include "engine/formulas/projection.h"

namespace aligngs {

/// Everything blending needs of one Gaussian, in one place because a tile gathers it from anywhere in memory.
///
/// Instead of the conic A it holds the factor F of log2(e)/2 A = F F^T, F = [fxx 0; fxy fyy], so that exp(power) =
/// 2^-(p^2 + r^2) with p = fxx dx + fxy dy and r = fyy dy. The power is never positive. A needle keeps its digits even
/// if its terms a dx^2, 2 b dx dy, c dy^2 are a million times their sum.
struct alignas(16) Splat {
  float x, y;  ///< mean, pixels
  float fxx, fxy, fyy;
  float opacity;
  float level;  ///< log2(opacity / alpha_min): alpha >= alpha_min where p^2 + r^2 <= level
  float color[3];
  float normal[3], distance;  ///< plane, camera frame
  float z, z_min, z_max;      ///< depth of the centre and bounds of the intersection depth
  uint32_t slot_stride;       ///< the slot of the instance in tile (x, y) is slot_origin + y slot_stride + x;
  int64_t slot_origin;        ///< both are written when the tiles' lists are built
  ALIGNGS_HD int64_t slot(int tile_x, int tile_y) const { return slot_origin + int64_t(tile_y) * slot_stride + tile_x; }
};
static_assert(sizeof(Splat) == 80, "one and a quarter cache lines");

/// The part of a projection that intersection_depth (blending.h) reads.
ALIGNGS_HD inline Projection<float> plane_of(const Splat& g) {
  Projection<float> plane;
  plane.normal = {g.normal[0], g.normal[1], g.normal[2]};
  plane.distance = g.distance;
  plane.z = g.z;
  plane.z_min = g.z_min;
  plane.z_max = g.z_max;
  return plane;
}

/// Half-open range of tiles.
struct TileRect {
  uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  ALIGNGS_HD uint32_t area() const { return uint32_t(x1 - x0) * uint32_t(y1 - y0); }
};

}  // namespace aligngs
