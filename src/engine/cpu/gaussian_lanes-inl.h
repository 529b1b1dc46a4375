// One Gaussian per lane: the vector twins of engine/formulas/projection.h and of core/spherical_harmonics.h that the
// projection and its backward pass share. Compiled once per instruction set.
#if defined(ALIGNGS_ENGINE_CPU_GAUSSIAN_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ALIGNGS_ENGINE_CPU_GAUSSIAN_LANES_INL_H_
#undef ALIGNGS_ENGINE_CPU_GAUSSIAN_LANES_INL_H_
#else
#define ALIGNGS_ENGINE_CPU_GAUSSIAN_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"
#include "engine/formulas/projection.h"
#include "gaussians/gaussian_model.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE FloatVec constant(float x) { return hn::Set(FloatTag(), x); }
/// a b + c d + e f
HWY_INLINE FloatVec dot3(FloatVec a, FloatVec b, FloatVec c, FloatVec d, FloatVec e, FloatVec f) {
  return hn::MulAdd(a, b, hn::MulAdd(c, d, hn::Mul(e, f)));
}

/// A vector per lane.
struct Lanes3 {
  FloatVec x, y, z;
};
HWY_INLINE FloatVec dot(const Lanes3& a, const Lanes3& b) { return dot3(a.x, b.x, a.y, b.y, a.z, b.z); }
HWY_INLINE Lanes3 scaled(const Lanes3& a, FloatVec s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }

#if HWY_TARGET != HWY_SCALAR
using Quad = HWY_CAPPED(float, 4);
using QuadVec = hn::Vec<Quad>;
/// out[k][i] = r[i][k].
HWY_INLINE void transpose_4x4(const QuadVec* r, QuadVec* out) {
  const Quad d;
  const hn::Repartition<double, Quad> dd;
  const auto a = hn::BitCast(dd, hn::InterleaveLower(d, r[0], r[1]));
  const auto b = hn::BitCast(dd, hn::InterleaveLower(d, r[2], r[3]));
  const auto c = hn::BitCast(dd, hn::InterleaveUpper(d, r[0], r[1]));
  const auto e = hn::BitCast(dd, hn::InterleaveUpper(d, r[2], r[3]));
  out[0] = hn::BitCast(d, hn::InterleaveLower(dd, a, b));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(dd, a, b));
  out[2] = hn::BitCast(d, hn::InterleaveLower(dd, c, e));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(dd, c, e));
}
#endif

/// out[j][lane] = rows[lane][j] for j < width, a multiple of 4.
HWY_INLINE void rows_to_lanes(const float* const* rows, size_t width, float (*out)[kLanes]) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t j = 0; j < width; ++j) out[j][0] = rows[0][j];
#else
  const Quad d;
  for (size_t lane = 0; lane < kLanes; lane += 4) {
    for (size_t j = 0; j < width; j += 4) {
      QuadVec in[4], turned[4];
      for (size_t i = 0; i < 4; ++i) in[i] = hn::LoadU(d, rows[lane + i] + j);
      transpose_4x4(in, turned);
      for (size_t i = 0; i < 4; ++i) hn::Store(turned[i], d, out[j + i] + lane);
    }
  }
#endif
}

/// rows[lane][j] = in[j][lane] for j < width, a multiple of 4, and the first `count` lanes.
HWY_INLINE void lanes_to_rows(const float (*in)[kLanes], size_t width, size_t count, float* const* rows) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t j = 0; j < width && count > 0; ++j) rows[0][j] = in[j][0];
#else
  const Quad d;
  for (size_t lane = 0; lane < count; lane += 4) {
    for (size_t j = 0; j < width; j += 4) {
      QuadVec from[4], turned[4];
      for (size_t i = 0; i < 4; ++i) from[i] = hn::Load(d, in[j + i] + lane);
      transpose_4x4(from, turned);
      for (size_t i = 0; i < 4 && lane + i < count; ++i) hn::StoreU(turned[i], d, rows[lane + i] + j);
    }
  }
#endif
}

/// Rounded up to whole quads.
constexpr size_t whole_quads(size_t width) { return (width + 3) / 4 * 4; }

/// Parameters of the current rows; the camera's constants.
struct LaneShape {
  Lanes3 position, log_scale;
  FloatVec rotation[4];  ///< w x y z
  FloatVec opacity_logit;
};
struct LaneCamera {
  FloatVec r[9], t[3], centre[3], fx, fy, cx, cy;

  explicit LaneCamera(const ProjectionCamera<float>& c)
      : fx(constant(c.fx)), fy(constant(c.fy)), cx(constant(c.cx)), cy(constant(c.cy)) {
    for (int i = 0; i < 9; ++i) r[i] = constant(c.rotation.m[i]);
    for (int i = 0; i < 3; ++i) t[i] = constant(c.translation[i]);
    for (int i = 0; i < 3; ++i) centre[i] = constant(c.centre[i]);
  }
  HWY_INLINE Lanes3 to_camera(const Lanes3& p) const {
    return {hn::Add(dot3(r[0], p.x, r[1], p.y, r[2], p.z), t[0]), hn::Add(dot3(r[3], p.x, r[4], p.y, r[5], p.z), t[1]),
            hn::Add(dot3(r[6], p.x, r[7], p.y, r[8], p.z), t[2])};
  }
};

/// projection_detail::Frame: axes in the camera frame, scales, and the rows u, v of J V S.
struct LaneFrame {
  FloatVec q[4], inverse_length;  ///< unit quaternion; 1 / length of the stored one, 0 when it has no direction
  FloatVec axes[9];
  FloatVec scale[3], u[3], v[3];
  FloatVec inverse_z, slope_x, slope_y;  ///< slopes after the clamp
  FloatVec free_x, free_y;               ///< 1 where the slope is not clamped, else 0
  FloatVec raw_slope_x, raw_slope_y;
};

HWY_INLINE void lane_frame(const LaneShape& g, const LaneCamera& c, const ProjectionCamera<float>& camera,
                           const Lanes3& centre, LaneFrame& f) {
  const FloatTag d;
  const FloatVec one = constant(1.0f), two = constant(2.0f), zero = hn::Zero(d);
  const FloatVec* r = g.rotation;
  const FloatVec length = hn::Sqrt(hn::MulAdd(r[0], r[0], dot3(r[1], r[1], r[2], r[2], r[3], r[3])));
  const auto directed = hn::Gt(length, zero);
  f.inverse_length = hn::IfThenElseZero(directed, hn::Div(one, length));
  f.q[0] = hn::IfThenElse(directed, hn::Mul(r[0], f.inverse_length), one);
  for (int k = 1; k < 4; ++k) f.q[k] = hn::Mul(r[k], f.inverse_length);
  const FloatVec w = f.q[0], x = f.q[1], y = f.q[2], z = f.q[3];
  const FloatVec m[9] = {hn::NegMulAdd(two, hn::MulAdd(y, y, hn::Mul(z, z)), one),
                         hn::Mul(two, hn::MulSub(x, y, hn::Mul(w, z))),
                         hn::Mul(two, hn::MulAdd(x, z, hn::Mul(w, y))),
                         hn::Mul(two, hn::MulAdd(x, y, hn::Mul(w, z))),
                         hn::NegMulAdd(two, hn::MulAdd(x, x, hn::Mul(z, z)), one),
                         hn::Mul(two, hn::MulSub(y, z, hn::Mul(w, x))),
                         hn::Mul(two, hn::MulSub(x, z, hn::Mul(w, y))),
                         hn::Mul(two, hn::MulAdd(y, z, hn::Mul(w, x))),
                         hn::NegMulAdd(two, hn::MulAdd(x, x, hn::Mul(y, y)), one)};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      f.axes[3 * i + k] = dot3(c.r[3 * i], m[k], c.r[3 * i + 1], m[3 + k], c.r[3 * i + 2], m[6 + k]);
    }
  }
  const FloatVec largest = constant(88.0f);  // exp stays finite; its square does not, and such rows are culled
  f.scale[0] = fast_exp(d, hn::Min(g.log_scale.x, largest));
  f.scale[1] = fast_exp(d, hn::Min(g.log_scale.y, largest));
  f.scale[2] = fast_exp(d, hn::Min(g.log_scale.z, largest));
  f.inverse_z = hn::Div(one, centre.z);
  f.raw_slope_x = hn::Div(centre.x, centre.z);
  f.raw_slope_y = hn::Div(centre.y, centre.z);
  f.slope_x = hn::Min(hn::Max(f.raw_slope_x, constant(camera.slope_x_min)), constant(camera.slope_x_max));
  f.slope_y = hn::Min(hn::Max(f.raw_slope_y, constant(camera.slope_y_min)), constant(camera.slope_y_max));
  f.free_x = hn::IfThenElseZero(hn::Eq(f.slope_x, f.raw_slope_x), one);
  f.free_y = hn::IfThenElseZero(hn::Eq(f.slope_y, f.raw_slope_y), one);
  const FloatVec zoom_x = hn::Mul(c.fx, f.inverse_z), zoom_y = hn::Mul(c.fy, f.inverse_z);
  for (int k = 0; k < 3; ++k) {
    f.u[k] = hn::Mul(hn::Mul(f.scale[k], zoom_x), hn::NegMulAdd(f.slope_x, f.axes[6 + k], f.axes[k]));
    f.v[k] = hn::Mul(hn::Mul(f.scale[k], zoom_y), hn::NegMulAdd(f.slope_y, f.axes[6 + k], f.axes[3 + k]));
  }
}

/// Selects column k of a 3x3 matrix per lane: 0 unless is_1 or is_2.
template <class M>
HWY_INLINE Lanes3 select_column(const FloatVec* m, M is_1, M is_2) {
  return {hn::IfThenElse(is_2, m[2], hn::IfThenElse(is_1, m[1], m[0])),
          hn::IfThenElse(is_2, m[5], hn::IfThenElse(is_1, m[4], m[3])),
          hn::IfThenElse(is_2, m[8], hn::IfThenElse(is_1, m[7], m[6]))};
}

/// sh_basis.
HWY_INLINE void lane_sh_basis(int degree, const Lanes3& n, FloatVec* out) {
  out[0] = constant(static_cast<float>(kSh0));
  if (degree < 1) return;
  const FloatVec x = n.x, y = n.y, z = n.z;
  const FloatVec c1 = constant(0.4886025119029199f);
  out[1] = hn::Neg(hn::Mul(c1, y));
  out[2] = hn::Mul(c1, z);
  out[3] = hn::Neg(hn::Mul(c1, x));
  if (degree < 2) return;
  const FloatVec xx = hn::Mul(x, x), yy = hn::Mul(y, y), zz = hn::Mul(z, z);
  const FloatVec a = constant(1.0925484305920792f), difference = hn::Sub(xx, yy);
  out[4] = hn::Mul(a, hn::Mul(x, y));
  out[5] = hn::Neg(hn::Mul(a, hn::Mul(y, z)));
  out[6] = hn::Mul(constant(0.31539156525252005f), hn::Sub(hn::Sub(hn::Add(zz, zz), xx), yy));
  out[7] = hn::Neg(hn::Mul(a, hn::Mul(x, z)));
  out[8] = hn::Mul(constant(0.5462742152960396f), difference);
  if (degree < 3) return;
  const FloatVec c9 = constant(-0.5900435899266435f), c11 = constant(-0.4570457994644658f), three = constant(3.0f);
  const FloatVec four_zz = hn::Sub(hn::Sub(hn::Mul(constant(4.0f), zz), xx), yy);
  out[9] = hn::Mul(hn::Mul(c9, y), hn::MulSub(three, xx, yy));
  out[10] = hn::Mul(hn::Mul(constant(2.890611442640554f), x), hn::Mul(y, z));
  out[11] = hn::Mul(hn::Mul(c11, y), four_zz);
  out[12] = hn::Mul(hn::Mul(constant(0.3731763325901154f), z),
                    hn::MulSub(constant(2.0f), zz, hn::Mul(three, hn::Add(xx, yy))));
  out[13] = hn::Mul(hn::Mul(c11, x), four_zz);
  out[14] = hn::Mul(hn::Mul(constant(1.445305721320277f), z), difference);
  out[15] = hn::Mul(hn::Mul(c9, x), hn::NegMulAdd(three, yy, xx));
}

/// sh_basis_gradient; `k` are the weights.
HWY_INLINE Lanes3 lane_sh_basis_gradient(int degree, const Lanes3& n, const FloatVec* k) {
  const FloatTag d;
  Lanes3 g{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  if (degree < 1) return g;
  const FloatVec x = n.x, y = n.y, z = n.z, c1 = constant(0.4886025119029199f);
  g.y = hn::NegMulAdd(c1, k[1], g.y);
  g.z = hn::MulAdd(c1, k[2], g.z);
  g.x = hn::NegMulAdd(c1, k[3], g.x);
  if (degree < 2) return g;
  const FloatVec a = constant(1.0925484305920792f), b2 = constant(2 * 0.31539156525252005f);
  const FloatVec c2 = constant(2 * 0.5462742152960396f);
  const FloatVec b6 = hn::Mul(b2, k[6]), c8 = hn::Mul(c2, k[8]);
  g.x = hn::Add(g.x, hn::MulAdd(a, hn::MulSub(k[4], y, hn::Mul(k[7], z)), hn::Mul(x, hn::Sub(c8, b6))));
  g.y = hn::Add(g.y, hn::MulSub(a, hn::MulSub(k[4], x, hn::Mul(k[5], z)), hn::Mul(y, hn::Add(b6, c8))));
  g.z = hn::Add(g.z, hn::MulSub(hn::Mul(constant(2.0f), b6), z, hn::Mul(a, hn::MulAdd(k[5], y, hn::Mul(k[7], x)))));
  if (degree < 3) return g;
  const FloatVec xx = hn::Mul(x, x), yy = hn::Mul(y, y), zz = hn::Mul(z, z), three = constant(3.0f);
  const FloatVec xy = hn::Mul(x, y), yz = hn::Mul(y, z), xz = hn::Mul(x, z), difference = hn::Sub(xx, yy);
  const FloatVec k9 = hn::Mul(constant(-0.5900435899266435f), k[9]), k10 = hn::Mul(constant(2.890611442640554f), k[10]);
  const FloatVec k11 = hn::Mul(constant(-0.4570457994644658f), k[11]),
                 k12 = hn::Mul(constant(0.3731763325901154f), k[12]);
  const FloatVec k13 = hn::Mul(constant(-0.4570457994644658f), k[13]),
                 k14 = hn::Mul(constant(1.445305721320277f), k[14]);
  const FloatVec k15 = hn::Mul(constant(-0.5900435899266435f), k[15]), six = constant(6.0f), two = constant(2.0f);
  const FloatVec four_zz = hn::Mul(constant(4.0f), zz), eight = constant(8.0f);
  FloatVec s = hn::Mul(hn::Mul(six, k9), xy);
  s = hn::MulAdd(k10, yz, s);
  s = hn::NegMulAdd(hn::Mul(two, k11), xy, s);
  s = hn::NegMulAdd(hn::Mul(six, k12), xz, s);
  s = hn::MulAdd(k13, hn::Sub(hn::NegMulAdd(three, xx, four_zz), yy), s);
  s = hn::MulAdd(hn::Mul(two, k14), xz, s);
  g.x = hn::Add(g.x, hn::MulAdd(hn::Mul(three, k15), difference, s));
  s = hn::Mul(hn::Mul(three, k9), difference);
  s = hn::MulAdd(k10, xz, s);
  s = hn::MulAdd(k11, hn::Sub(hn::NegMulAdd(three, yy, four_zz), xx), s);
  s = hn::NegMulAdd(hn::Mul(six, k12), yz, s);
  s = hn::NegMulAdd(hn::Mul(two, k13), xy, s);
  s = hn::NegMulAdd(hn::Mul(two, k14), yz, s);
  g.y = hn::Add(g.y, hn::NegMulAdd(hn::Mul(six, k15), xy, s));
  s = hn::Mul(k10, xy);
  s = hn::MulAdd(hn::Mul(eight, k11), yz, s);
  s = hn::MulAdd(k12, hn::Mul(three, hn::Sub(hn::Mul(two, zz), hn::Add(xx, yy))), s);
  s = hn::MulAdd(hn::Mul(eight, k13), xz, s);
  g.z = hn::Add(g.z, hn::MulAdd(k14, difference, s));
  return g;
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
