// Terms that compare a pixel with its neighbours: depth normals, and pairs across label edges. They belong to the
// second pass of map_losses.cu.
#pragma once

#include "engine/cuda/pixel_terms.cuh"

namespace aligngs::cuda {

// ---- pairs across label edges ----

/// The pair whose first pixel is (x, y), or none; dx, dy: (1, 0) or (0, 1).
struct EdgeAt {
  uint8_t flags = 0;
  __device__ bool pair(int dx) const { return (flags & (dx != 0 ? kPixelRightPair : kPixelLowerPair)) != 0; }
  __device__ bool crease(int dx) const { return (flags & (dx != 0 ? kPixelRightCrease : kPixelLowerCrease)) != 0; }
  __device__ bool coplanar(int dx) const {
    return (flags & (dx != 0 ? kPixelRightCoplanar : kPixelLowerCoplanar)) != 0;
  }
};
__device__ __forceinline__ EdgeAt edge_at(const MapTermInputs& in, int x, int y) {
  if (x < 0 || y < 0 || x >= in.maps.width || y >= in.maps.height) return {};
  return {in.view.flags[size_t(y) * in.maps.width + x]};
}

/// A pair that L_nb looks at: both directions known and, by default, an unbroken surface.
__device__ __forceinline__ bool in_boundary(const MapTermInputs& in, const MapTermScratch& scratch, size_t u,
                                            size_t v) {
  return in.settings.paper_normals ||
         unbroken_depth(scratch.depth[u], scratch.validity[u], scratch.depth[v], scratch.validity[v]);
}

/// Steps from the first pixel of a pair to where the crease loss reads the prior and the render, on either side.
inline constexpr int kPriorOut = kCreasePriorOffset - 1, kRenderOut = kCreaseRenderOffset - 1;

/// The smaller weight of the two prior pixels of the pair that begins at u.
__device__ __forceinline__ float crease_weight(const MapTermInputs& in, size_t u, size_t step) {
  const float before = depth_weight_at(in.view, u - kPriorOut * step);
  const float after = depth_weight_at(in.view, u + (kPriorOut + 1) * step);
  return before < after ? before : after;
}

// ---- comparisons of neighbours ----

__device__ __forceinline__ void compare_depth_normal(const MapTermInputs& in, const MapTermScratch& scratch, int x,
                                                     int y, size_t i, DeviceSpan<float> d_normal,
                                                     float (&sums)[kComparedSums]) {
  const size_t pixels = pixels_of(in), width = static_cast<size_t>(in.maps.width);
  const UnitNormal<float> unit = unit_normal_at(in, i);
  DepthStencil stencil;
  if (unit.valid()) {
    stencil = depth_stencil(scratch.depth.data, scratch.validity.data, x, y, in.maps.width, in.maps.height,
                            in.settings.paper_normals);
  }
  NormalComparison<float> c{};
  if (stencil.valid()) {
    const Reach h = reach_of(stencil.horizontal), v = reach_of(stencil.vertical);
    const DepthNeighbours<float> neighbours{scratch.depth[i + h.after],
                                            scratch.depth[i - h.before],
                                            scratch.depth[i - v.before * width],
                                            scratch.depth[i + v.after * width],
                                            float(h.after),
                                            float(-h.before),
                                            float(-v.before),
                                            float(v.after),
                                            1.0f};
    const Vec3<float> ray = in.view.rays(x, y);
    c = compare_normals(neighbours, ray.x, ray.y, in.view.rays.step_x, in.view.rays.step_y, unit.direction,
                        unit.inverse_length, 1.0f);
    scratch.neighbours[i] = make_float4(c.d_right, c.d_left, c.d_top, c.d_bottom);
    sums[kConsistencyCount] = 1;
    sums[kConsistencyValue] = c.loss;
  }
  scratch.stencil[i] = stencil.valid() ? stencil.packed() : uint8_t(0);
  d_normal[i] = c.d_x;
  d_normal[pixels + i] = c.d_y;
  d_normal[2 * pixels + i] = c.d_z;
}

/// The terms of the pairs that begin at pixel i.
__device__ __forceinline__ void compare_pairs(const MapTermInputs& in, const MapTermScratch& scratch, int x, int y,
                                              size_t i, float (&sums)[kComparedSums]) {
  const EdgeAt edge = edge_at(in, x, y);
  if ((edge.flags & (kPixelRightPair | kPixelLowerPair)) == 0) return;
  const size_t pixels = pixels_of(in);
  for (int dx = 0; dx < 2; ++dx) {
    if (!edge.pair(dx)) continue;
    const size_t step = dx != 0 ? 1 : static_cast<size_t>(in.maps.width), v = i + step;
    if (in.settings.weight[Loss::kNormalBoundary] != 0 && in_boundary(in, scratch, i, v)) {
      const UnitNormal<float> a = unit_normal_at(in, i), b = unit_normal_at(in, v);
      if (a.valid() && b.valid()) {
        sums[kBoundaryCount] += 1;
        sums[kBoundaryValue] += static_cast<float>(boundary_penalty(dot(a.direction, b.direction)));
      }
    }
    if (in.settings.weight[Loss::kCrease] == 0) continue;
    if (edge.crease(dx)) {
      const float weight = crease_weight(in, i, step);
      const UnitNormal<float> a = unit_normal_at(in, i - kRenderOut * step),
                              b = unit_normal_at(in, v + kRenderOut * step);
      const Vec3<float> before = vector_at(in.view.prior_normal, i - kPriorOut * step, pixels),
                        after = vector_at(in.view.prior_normal, v + kPriorOut * step, pixels);
      sums[kCreaseWeight] += (a.valid() ? weight : 0) + (b.valid() ? weight : 0);
      if (a.valid()) sums[kCreaseValue] += weight * (1 - dot(a.direction, before));
      if (b.valid()) sums[kCreaseValue] += weight * (1 - dot(b.direction, after));
    } else if (edge.coplanar(dx)) {
      const float weight = crease_weight(in, i, step);
      const UnitNormal<float> a = unit_normal_at(in, i), b = unit_normal_at(in, v);
      if (a.valid() && b.valid()) {
        sums[kCreaseWeight] += weight;
        sums[kCreaseValue] += weight * (1 - dot(a.direction, b.direction));
      }
    }
  }
}

}  // namespace aligngs::cuda
