#include "engine/cpu/blend_backward.h"

#include "engine/cpu/simd_targets.h"
#include "engine/formulas/blending.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/blend_backward.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/intersection-inl.h"
#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// Moments of g in whitened coordinates.
struct Moments {
  FloatVec p, r, one, pp, pr, rr;
};
HWY_INLINE Moments zero_moments() {
  const FloatVec zero = hn::Zero(FloatTag());
  return {zero, zero, zero, zero, zero, zero};
}
HWY_INLINE void add_moments(FloatVec g, FloatVec p, FloatVec r, Moments& m) {
  const FloatVec gp = hn::Mul(g, p), gr = hn::Mul(g, r);
  m.one = hn::Add(m.one, g);
  m.p = hn::Add(m.p, gp);
  m.r = hn::Add(m.r, gr);
  m.pp = hn::MulAdd(gp, p, m.pp);
  m.pr = hn::MulAdd(gp, r, m.pr);
  m.rr = hn::MulAdd(gr, r, m.rr);
}

/// First pixel of the lowest strip in a set of strips.
HWY_INLINE size_t first_strip(uint32_t strips) {
  return hwy::Num0BitsBelowLS1Bit_Nonzero32(strips) * static_cast<size_t>(kStripPixels);
}

/// Rays of a block's pixels.
struct BlockRays {
  HWY_ALIGN float x[kBlockPixels];
  HWY_ALIGN float y[kBlockPixels];
  HWY_ALIGN float grazing[kBlockPixels];
};
void block_rays(const BlockWeights& block, const ProjectionCamera<float>& camera, BlockRays& rays) {
  const FloatTag d;
  for (size_t at = 0; at < kBlockPixels; at += kLanes) {
    const RayLanes ray = ray_lanes(camera, pixel_centres_x(block.x, at), pixel_centres_y(block.y, at));
    hn::Store(ray.x, d, rays.x + at);
    hn::Store(ray.y, d, rays.y + at);
    hn::Store(ray.grazing, d, rays.grazing + at);
  }
}

/// What stands behind the Gaussian at hand, per pixel.
struct Behind {
  HWY_ALIGN float color[kBlockPixels];
  HWY_ALIGN float all[kBlockPixels];
  HWY_ALIGN float semantic[kBlockPixels];
};

template <bool kGeometry, bool kDensity, bool kCoupling, bool kSmooth>
void sweep(const TileWeights& tile, const BlockWeights& block, const BlockRays& rays, const RasterSettings& raster,
           const BlockGradients& in, const float* coupling, SplatGradient* sums) {
  const FloatTag d;
  const FloatVec zero = hn::Zero(d), alpha_max = hn::Set(d, raster.alpha_max);
  HWY_ALIGN float pixel_x[kBlockPixels], pixel_y[kBlockPixels];
  for (int i = 0; i < kBlockPixels; ++i) {
    pixel_x[i] = block.x + (i % kBlockSize) + 0.5f;
    pixel_y[i] = block.y + (i / kBlockSize) + 0.5f;
  }
  Behind behind;
  for (size_t s = 0; s < kBlockPixels; s += kLanes) {
    FloatVec b = hn::Mul(hn::Set(d, raster.background[0]), hn::Load(d, in.color[0] + s));
    b = hn::MulAdd(hn::Set(d, raster.background[1]), hn::Load(d, in.color[1] + s), b);
    b = hn::MulAdd(hn::Set(d, raster.background[2]), hn::Load(d, in.color[2] + s), b);
    hn::Store(b, d, behind.color + s);
    hn::Store(b, d, behind.all + s);
    hn::Store(zero, d, behind.semantic + s);
  }
  for (size_t e = block.count; e-- > 0;) {
    const Splat& g = tile.splats[block.entry[e]];
    float* HWY_RESTRICT out = reinterpret_cast<float*>(sums + block.entry[e]);
    const float* HWY_RESTRICT weight = block.weight.data() + e * kBlockPixels;
    const float* HWY_RESTRICT alpha = block.alpha.data() + e * kBlockPixels;
    const float* HWY_RESTRICT gain = kSmooth ? block.gain.data() + e * kBlockPixels : nullptr;
    const uint32_t strips = block.strips[e];
    FloatVec c0 = zero, c1 = zero, c2 = zero, w_sum = zero, n0 = zero, n1 = zero, n2 = zero, dist = zero;
    FloatVec residual = zero, unsupported = zero;
    Moments all = zero_moments();
    FloatVec photo_p = zero, photo_r = zero, abs_p = zero, abs_y = zero;
    const FloatVec gx = hn::Set(d, g.x), gy = hn::Set(d, g.y), fxx = hn::Set(d, g.fxx), fxy = hn::Set(d, g.fxy),
                   fyy = hn::Set(d, g.fyy);
    FloatVec fdx = hn::Mul(fxx, hn::Sub(hn::Load(d, pixel_x), gx));  // the same for all vectors of whole rows
    for (uint32_t left = strips; left != 0; left &= left - 1) {
      const size_t first = first_strip(left);
      for (size_t s = first; s < first + kStripPixels; s += kLanes) {
        const FloatVec w = hn::Load(d, weight + s);
        c0 = hn::MulAdd(w, hn::Load(d, in.color[0] + s), c0);
        c1 = hn::MulAdd(w, hn::Load(d, in.color[1] + s), c1);
        c2 = hn::MulAdd(w, hn::Load(d, in.color[2] + s), c2);
        w_sum = hn::Add(w_sum, w);
        if constexpr (kGeometry) {
          n0 = hn::MulAdd(w, hn::Load(d, in.normal[0] + s), n0);
          n1 = hn::MulAdd(w, hn::Load(d, in.normal[1] + s), n1);
          n2 = hn::MulAdd(w, hn::Load(d, in.normal[2] + s), n2);
          dist = hn::MulAdd(w, hn::Load(d, in.distance + s), dist);
        }
        if constexpr (kDensity) {
          residual = hn::MulAdd(w, hn::Load(d, in.residual + s), residual);
          const FloatVec z =
              intersection(d, g, hn::Load(d, rays.x + s), hn::Load(d, rays.y + s), hn::Load(d, rays.grazing + s));
          const FloatVec prior = hn::Load(d, in.prior + s);
          const FloatVec allowed = hn::Mul(hn::Set(d, float(kPriorSupport)), prior);
          const auto supported = hn::And(hn::Le(hn::Abs(hn::Sub(z, prior)), allowed), hn::Gt(prior, zero));
          unsupported = hn::Add(unsupported, hn::IfThenZeroElse(supported, w));
        }
        const FloatVec a = hn::Load(d, alpha + s);
        const FloatVec slope =
            kSmooth ? hn::Load(d, gain + s) : hn::IfThenElseZero(hn::Lt(a, alpha_max), w);
        if (kLanes < kBlockSize) fdx = hn::Mul(fxx, hn::Sub(hn::Load(d, pixel_x + s), gx));
        const FloatVec dy = hn::Sub(hn::Load(d, pixel_y + s), gy);
        const FloatVec p = hn::MulAdd(fxy, dy, fdx), r = hn::Mul(fyy, dy);
        FloatVec v = hn::Mul(hn::Set(d, g.color[0]), hn::Load(d, in.color[0] + s));
        v = hn::MulAdd(hn::Set(d, g.color[1]), hn::Load(d, in.color[1] + s), v);
        v = hn::MulAdd(hn::Set(d, g.color[2]), hn::Load(d, in.color[2] + s), v);
        const FloatVec behind_color = hn::Load(d, behind.color + s);
        const FloatVec step_color = hn::Sub(v, behind_color);
        hn::Store(hn::MulAdd(a, step_color, behind_color), d, behind.color + s);
        const FloatVec g_color = hn::Mul(slope, step_color);
        FloatVec g_all = g_color;
        if constexpr (kGeometry) {
          v = hn::MulAdd(hn::Set(d, g.normal[0]), hn::Load(d, in.normal[0] + s), v);
          v = hn::MulAdd(hn::Set(d, g.normal[1]), hn::Load(d, in.normal[1] + s), v);
          v = hn::MulAdd(hn::Set(d, g.normal[2]), hn::Load(d, in.normal[2] + s), v);
          v = hn::Add(hn::MulAdd(hn::Set(d, g.distance), hn::Load(d, in.distance + s), v), hn::Load(d, in.alpha + s));
          const FloatVec behind_all = hn::Load(d, behind.all + s);
          const FloatVec step = hn::Sub(v, behind_all);
          hn::Store(hn::MulAdd(a, step, behind_all), d, behind.all + s);
          g_all = hn::Mul(slope, step);
        }
        add_moments(g_all, p, r, all);
        if constexpr (kGeometry) {
          photo_p = hn::MulAdd(g_color, p, photo_p);
          photo_r = hn::MulAdd(g_color, r, photo_r);
        }
        if constexpr (kDensity) {
          abs_p = hn::Add(abs_p, hn::Abs(hn::Mul(g_color, p)));
          abs_y = hn::Add(abs_y, hn::Abs(hn::Mul(g_color, hn::MulAdd(fxy, p, hn::Mul(fyy, r)))));
        }
      }
    }
    add_lane_sums(d, c0, c1, c2, w_sum, out);
    if constexpr (kGeometry) add_lane_sums(d, n0, n1, n2, dist, out + 4);
    add_lane_sums(d, all.p, all.r, all.one, all.pp, out + 8);
    add_lane_sums(d, all.pr, all.rr, residual, unsupported, out + 12);
    if constexpr (!kGeometry) {
      photo_p = all.p;
      photo_r = all.r;
    }
    add_lane_sums(d, photo_p, photo_r, abs_p, abs_y, out + 16);
    if constexpr (kCoupling) {
      // A loop of its own, because the registers hold no more sums.
      Moments semantic = zero_moments();
      for (uint32_t left = strips; left != 0; left &= left - 1) {
        const size_t first = first_strip(left);
        for (size_t s = first; s < first + kStripPixels; s += kLanes) {
          const FloatVec a = hn::Load(d, alpha + s);
          const FloatVec slope = kSmooth ? hn::Load(d, gain + s)
                                         : hn::IfThenElseZero(hn::Lt(a, alpha_max), hn::Load(d, weight + s));
          if (kLanes < kBlockSize) fdx = hn::Mul(fxx, hn::Sub(hn::Load(d, pixel_x + s), gx));
          const FloatVec dy = hn::Sub(hn::Load(d, pixel_y + s), gy);
          const FloatVec p = hn::MulAdd(fxy, dy, fdx), r = hn::Mul(fyy, dy);
          const FloatVec q = hn::Load(d, coupling + e * kBlockPixels + s);
          const FloatVec behind_semantic = hn::Load(d, behind.semantic + s);
          const FloatVec step = hn::Sub(q, behind_semantic);
          hn::Store(hn::MulAdd(a, step, behind_semantic), d, behind.semantic + s);
          add_moments(hn::Mul(slope, step), p, r, semantic);
        }
      }
      add_lane_sums(d, semantic.p, semantic.r, semantic.one, semantic.pp, out + 20);
      add_lane_sums(d, semantic.pr, semantic.rr, zero, zero, out + 24);
    }
  }
}

template <bool kGeometry, bool kDensity, bool kSmooth = false>
void sweep_with(const TileWeights& tile, const BlockWeights& block, const BlockRays& rays, const RasterSettings& raster,
                const BlockGradients& in, const float* coupling, SplatGradient* sums) {
  if (coupling != nullptr) {
    sweep<kGeometry, kDensity, true, kSmooth>(tile, block, rays, raster, in, coupling, sums);
  } else {
    sweep<kGeometry, kDensity, false, kSmooth>(tile, block, rays, raster, in, coupling, sums);
  }
}

void BlendBlockBackward(const TileWeights& tile, const BlockWeights& block, const ProjectionCamera<float>& camera,
                        const RasterSettings& raster, const BlockGradients& in, const BackwardOptions& options,
                        SplatGradient* sums) {
  BlockRays rays;
  if (options.density || raster.smooth_cutoff) block_rays(block, camera, rays);
  if (raster.smooth_cutoff) {  // for tests: one version that computes everything
    sweep_with<true, true, true>(tile, block, rays, raster, in, options.coupling, sums);
  } else if (options.geometry && options.density) {
    sweep_with<true, true>(tile, block, rays, raster, in, options.coupling, sums);
  } else if (options.geometry) {
    sweep_with<true, false>(tile, block, rays, raster, in, options.coupling, sums);
  } else if (options.density) {
    sweep_with<false, true>(tile, block, rays, raster, in, options.coupling, sums);
  } else {
    sweep_with<false, false>(tile, block, rays, raster, in, options.coupling, sums);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(BlendBlockBackward);

void blend_block_backward(const TileWeights& tile, const BlockWeights& block, const ProjectionCamera<float>& camera,
                          const RasterSettings& raster, const BlockGradients& gradients, const BackwardOptions& options,
                          SplatGradient* sums) {
  HWY_DYNAMIC_DISPATCH(BlendBlockBackward)(tile, block, camera, raster, gradients, options, sums);
}

}  // namespace aligngs::cpu
#endif
