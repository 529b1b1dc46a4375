// Gradients of the terms in map_terms.cuh. A pixel gathers those of its neighbours, in the third pass of map_losses.cu.
#pragma once

#include "engine/cuda/map_terms.cuh"

namespace aligngs::cuda {

/// The gradient of the pixel's depth by the depth normals of it and its four neighbours, not yet normalised.
__device__ __forceinline__ float gather_consistency(const MapTermInputs& in, const MapTermScratch& scratch, int x,
                                                    int y, size_t i) {
  const size_t width = static_cast<size_t>(in.maps.width);
  float g = 0;
  if (scratch.stencil[i] != 0) {
    // A one-sided difference uses the pixel itself.
    const DepthStencil own = DepthStencil::unpack(scratch.stencil[i]);
    const Reach h = reach_of(own.horizontal), v = reach_of(own.vertical);
    const float4 d = scratch.neighbours[i];
    g += (h.after == 0 ? d.x : 0) + (h.before == 0 ? d.y : 0) + (v.before == 0 ? d.z : 0) + (v.after == 0 ? d.w : 0);
  }
  const auto reach = [&](size_t j, bool horizontal) {
    const DepthStencil s = DepthStencil::unpack(scratch.stencil[j]);
    return reach_of(horizontal ? s.horizontal : s.vertical);
  };
  if (x > 0 && scratch.stencil[i - 1] != 0 && reach(i - 1, true).after != 0) g += scratch.neighbours[i - 1].x;
  if (x + 1 < in.maps.width && scratch.stencil[i + 1] != 0 && reach(i + 1, true).before != 0) {
    g += scratch.neighbours[i + 1].y;
  }
  if (y + 1 < in.maps.height && scratch.stencil[i + width] != 0 && reach(i + width, false).before != 0) {
    g += scratch.neighbours[i + width].z;
  }
  if (y > 0 && scratch.stencil[i - width] != 0 && reach(i - width, false).after != 0) {
    g += scratch.neighbours[i - width].w;
  }
  return g;
}

/// dL/d(unit normal) of pixel i from the pair (i, other) of L_nb.
__device__ __forceinline__ Vec3<float> boundary_gradient(const MapTermInputs& in, const MapTermScratch& scratch,
                                                         double step, const UnitNormal<float>& own, size_t first,
                                                         size_t second, size_t other) {
  if (!in_boundary(in, scratch, first, second)) return {};
  const UnitNormal<float> normal = unit_normal_at(in, other);
  if (!normal.valid()) return {};
  const double penalty = boundary_penalty(dot(own.direction, normal.direction));
  return normal.direction * static_cast<float>(step * boundary_slope(penalty));
}

/// dL/d(unit normal) of pixel i from every pair that it belongs to.
__device__ __forceinline__ Vec3<float> gather_pairs(const MapTermInputs& in, const MapTermScratch& scratch,
                                                    const ComparedTerms& c, const UnitNormal<float>& own, int x, int y,
                                                    size_t i) {
  const size_t pixels = pixels_of(in);
  Vec3<float> g;
  for (int dx = 0; dx < 2; ++dx) {
    const int dy = 1 - dx;
    const size_t step = dx != 0 ? 1 : static_cast<size_t>(in.maps.width);
    const EdgeAt here = edge_at(in, x, y), before = edge_at(in, x - dx, y - dy);
    if (c.boundary_step != 0) {
      if (here.pair(dx)) g += boundary_gradient(in, scratch, c.boundary_step, own, i, i + step, i + step);
      if (before.pair(dx)) g += boundary_gradient(in, scratch, c.boundary_step, own, i - step, i, i - step);
    }
    if (c.crease_step == 0) continue;
    if (here.coplanar(dx)) {
      const UnitNormal<float> n = unit_normal_at(in, i + step);
      if (n.valid()) g += n.direction * static_cast<float>(c.crease_step * crease_weight(in, i, step));
    }
    if (before.coplanar(dx)) {
      const UnitNormal<float> n = unit_normal_at(in, i - step);
      if (n.valid()) g += n.direction * static_cast<float>(c.crease_step * crease_weight(in, i - step, step));
    }
    // A crease compares pixels kRenderOut beyond the pair on either side with the prior further out.
    if (edge_at(in, x + kRenderOut * dx, y + kRenderOut * dy).crease(dx)) {
      const size_t first = i + kRenderOut * step;
      g += vector_at(in.view.prior_normal, first - kPriorOut * step, pixels) *
           static_cast<float>(c.crease_step * crease_weight(in, first, step));
    }
    if (edge_at(in, x - (kRenderOut + 1) * dx, y - (kRenderOut + 1) * dy).crease(dx)) {
      const size_t first = i - (kRenderOut + 1) * step;
      g += vector_at(in.view.prior_normal, first + (kPriorOut + 1) * step, pixels) *
           static_cast<float>(c.crease_step * crease_weight(in, first, step));
    }
  }
  return g;
}

}  // namespace aligngs::cuda
