#include "engine/cpu/blend_forward.h"

#include "engine/cpu/simd_targets.h"
#include "engine/formulas/blending.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/blend_forward.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/intersection-inl.h"
#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

template <bool kGeometry>
void blend_strip(const TileWeights& tile, const BlockWeights& block, size_t first, const BlockRays& rays,
                 const RasterSettings& raster, BlockMaps& maps) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, float(kMedianTransmittance));
  FloatVec c0 = zero, c1 = zero, c2 = zero, a = zero, n0 = zero, n1 = zero, n2 = zero, dist = zero, expected = zero,
           median = zero, t = one;
  FloatVec rx = zero, ry = zero, grazing = zero;
  if constexpr (kGeometry) {
    rx = hn::Load(d, rays.x + first);
    ry = hn::Load(d, rays.y + first);
    grazing = hn::Load(d, rays.grazing + first);
  }
  for (size_t e = 0; e < block.count; ++e) {
    const Splat& g = tile.splats[block.entry[e]];
    const FloatVec w = hn::Load(d, block.weight.data() + e * kBlockPixels + first);
    c0 = hn::MulAdd(w, hn::Set(d, g.color[0]), c0);
    c1 = hn::MulAdd(w, hn::Set(d, g.color[1]), c1);
    c2 = hn::MulAdd(w, hn::Set(d, g.color[2]), c2);
    a = hn::Add(a, w);
    if constexpr (kGeometry) {
      n0 = hn::MulAdd(w, hn::Set(d, g.normal[0]), n0);
      n1 = hn::MulAdd(w, hn::Set(d, g.normal[1]), n1);
      n2 = hn::MulAdd(w, hn::Set(d, g.normal[2]), n2);
      dist = hn::MulAdd(w, hn::Set(d, g.distance), dist);
      const FloatVec z = intersection(d, g, rx, ry, grazing);
      expected = hn::MulAdd(w, z, expected);
      const FloatVec alpha = hn::Load(d, block.alpha.data() + e * kBlockPixels + first);
      const FloatVec next = hn::NegMulAdd(alpha, t, t);  // as in tile_weights.cpp
      median = hn::IfThenElse(hn::And(hn::Ge(t, half), hn::Lt(next, half)), z, median);
      t = next;
    }
  }
  const FloatVec left = hn::Load(d, block.transmittance + first);
  hn::Store(hn::MulAdd(left, hn::Set(d, raster.background[0]), c0), d, maps.color[0] + first);
  hn::Store(hn::MulAdd(left, hn::Set(d, raster.background[1]), c1), d, maps.color[1] + first);
  hn::Store(hn::MulAdd(left, hn::Set(d, raster.background[2]), c2), d, maps.color[2] + first);
  hn::Store(a, d, maps.alpha + first);
  if constexpr (kGeometry) {
    hn::Store(n0, d, maps.normal[0] + first);
    hn::Store(n1, d, maps.normal[1] + first);
    hn::Store(n2, d, maps.normal[2] + first);
    hn::Store(dist, d, maps.distance + first);
    hn::Store(expected, d, maps.expected + first);
    hn::Store(median, d, maps.median + first);
  }
}

void BlendBlockForward(const TileWeights& tile, const BlockWeights& block, const ProjectionCamera<float>& camera,
                       const RasterSettings& raster, bool geometry, BlockMaps& maps) {
  BlockRays rays;
  if (geometry) block_rays(block, camera, rays);
  for (size_t first = 0; first < kBlockPixels; first += kLanes) {
    if (geometry) {
      blend_strip<true>(tile, block, first, rays, raster, maps);
    } else {
      blend_strip<false>(tile, block, first, rays, raster, maps);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BlendBlockForward);

void blend_block_forward(const TileWeights& tile, const BlockWeights& block, const ProjectionCamera<float>& camera,
                         const RasterSettings& raster, bool geometry, BlockMaps& maps) {
  HWY_DYNAMIC_DISPATCH(BlendBlockForward)(tile, block, camera, raster, geometry, maps);
}

void block_rays(const BlockWeights& block, const ProjectionCamera<float>& camera, BlockRays& rays) {
  for (int i = 0; i < kBlockPixels; ++i) {
    const Vec3<float> ray = camera.ray(block.x + i % kBlockSize, block.y + i / kBlockSize);
    rays.x[i] = ray.x;
    rays.y[i] = ray.y;
    rays.grazing[i] = static_cast<float>(kGrazingCosine) * norm(ray);
  }
}

}  // namespace aligngs::cpu
#endif
