#include "engine/cpu/project_backward.h"

#include <cstddef>

#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/project_backward.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/gaussian_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

constexpr float kTwoLn2 = 1.38629436f;  ///< the conic is 2 ln 2 F F^T (splats.h)

/// Places in Splat, as numbers.
constexpr size_t kSplatFactor = offsetof(Splat, fxx) / sizeof(float);
constexpr size_t kSplatOpacity = offsetof(Splat, opacity) / sizeof(float);
constexpr size_t kSplatColor = offsetof(Splat, color) / sizeof(float);
constexpr size_t kSplatNormal = offsetof(Splat, normal) / sizeof(float);
constexpr size_t kSplatFields = 16;  ///< a multiple of 4 that holds those above
static_assert(kSplatNormal + 3 <= kSplatFields);

/// Places in RowGradient, as numbers.
constexpr size_t kRowPosition = offsetof(RowGradient, position) / sizeof(float);
constexpr size_t kRowLogScale = offsetof(RowGradient, log_scale) / sizeof(float);
constexpr size_t kRowRotation = offsetof(RowGradient, rotation) / sizeof(float);
constexpr size_t kRowOpacityLogit = offsetof(RowGradient, opacity_logit) / sizeof(float);

constexpr size_t kRowFields = sizeof(RowGradient) / sizeof(float);

/// Inputs of a batch, one row per lane.
struct LaneInputs {
  HWY_ALIGN float position[3][kLanes], log_scale[3][kLanes], rotation[4][kLanes];
  HWY_ALIGN float sh[3 * kShCoefficients][kLanes];
  HWY_ALIGN float sums[kCoupledSplatGradientFloats][kLanes];  ///< CoupledSplatGradient
  HWY_ALIGN float splat[kSplatFields][kLanes];                ///< Splat
};
struct LaneOutputs {
  HWY_ALIGN float row[kRowFields][kLanes];  ///< in the order of RowGradient
  HWY_ALIGN float sh[3 * kShCoefficients][kLanes];
};

void load_lanes(const ProjectBackwardInputs& in, const uint32_t* rows, const CoupledSplatGradient* sums, size_t count,
                LaneInputs& out) {
  const GaussianModel& m = in.model;
  const float *sh[kLanes], *sum[kLanes], *splats[kLanes], *rotations[kLanes];
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const size_t k = HWY_MIN(lane, count - 1), row = rows[k];
    for (size_t j = 0; j < 3; ++j) out.position[j][lane] = m.positions[3 * row + j];
    for (size_t j = 0; j < 3; ++j) out.log_scale[j][lane] = m.log_scales[3 * row + j];
    rotations[lane] = &m.rotations[4 * row];
    sh[lane] = &m.sh[3 * kShCoefficients * row];
    sum[lane] = reinterpret_cast<const float*>(sums + k);
    splats[lane] = reinterpret_cast<const float*>(&in.view.splats[row]);
  }
  rows_to_lanes(rotations, 4, out.rotation);
  rows_to_lanes(sh, whole_quads(static_cast<size_t>(3 * sh_coefficient_count(in.sh_degree))), out.sh);
  rows_to_lanes(sum, kCoupledSplatGradientFloats, out.sums);
  rows_to_lanes(splats, kSplatFields, out.splat);
}

/// The vector twin of rotation_backward: dL/dR to the stored quaternion.
HWY_INLINE void rotation_lanes(const LaneFrame& f, const FloatVec* g, FloatVec* out) {
  const FloatVec w = f.q[0], x = f.q[1], y = f.q[2], z = f.q[3], two = constant(2.0f);
  const FloatVec a = hn::Sub(g[3], g[1]), b = hn::Sub(g[2], g[6]), c = hn::Sub(g[7], g[5]);  // antisymmetric
  const FloatVec d = hn::Add(g[1], g[3]), e = hn::Add(g[2], g[6]), h = hn::Add(g[5], g[7]);  // symmetric
  const FloatVec dw = hn::Mul(two, dot3(z, a, y, b, x, c));
  const FloatVec dx = hn::Mul(two, hn::Sub(dot3(y, d, z, e, w, c), hn::Mul(hn::Mul(two, x), hn::Add(g[4], g[8]))));
  const FloatVec dy = hn::Mul(two, hn::Sub(dot3(x, d, z, h, w, b), hn::Mul(hn::Mul(two, y), hn::Add(g[0], g[8]))));
  const FloatVec dz = hn::Mul(two, hn::Sub(dot3(x, e, y, h, w, a), hn::Mul(hn::Mul(two, z), hn::Add(g[0], g[4]))));
  const FloatVec along = hn::MulAdd(w, dw, dot3(x, dx, y, dy, z, dz));
  out[0] = hn::Mul(hn::NegMulAdd(along, w, dw), f.inverse_length);
  out[1] = hn::Mul(hn::NegMulAdd(along, x, dx), f.inverse_length);
  out[2] = hn::Mul(hn::NegMulAdd(along, y, dy), f.inverse_length);
  out[3] = hn::Mul(hn::NegMulAdd(along, z, dz), f.inverse_length);
}

/// The vector twin of project_backward and sh_color_backward. M are the moments of g in whitened coordinates y = F^T d.
/// With A = k F F^T and dL/dA = -1/2 sum g d d^T, the gradient of the covariance is
///   dC = -A dL/dA A = k^2/2 F M F^T,
/// which unlike the way over dL/dA does not cancel for needles.
void backward_lanes(const ProjectBackwardInputs& in, const LaneInputs& l, LaneOutputs& out) {
  const FloatTag d;
  const auto load = [&](const float* p) HWY_ATTR { return hn::Load(d, p); };
  LaneShape g;
  g.position = {load(l.position[0]), load(l.position[1]), load(l.position[2])};
  g.log_scale = {load(l.log_scale[0]), load(l.log_scale[1]), load(l.log_scale[2])};
  for (int k = 0; k < 4; ++k) g.rotation[k] = load(l.rotation[k]);
  const ProjectionCamera<float>& camera = in.view.camera;
  const LaneCamera c(camera);
  const Lanes3 centre = c.to_camera(g.position);
  LaneFrame f;
  lane_frame(g, c, camera, centre, f);

  // Moments: those of the map losses, plus the factor times those of the coupling.
  FloatVec p = load(l.sums[kSumP]), r = load(l.sums[kSumR]), sum = load(l.sums[kSumOne]), pp = load(l.sums[kSumPp]),
           pr = load(l.sums[kSumPr]), rr = load(l.sums[kSumRr]);
  if (in.coupling_scale != 0) {
    const FloatVec s = constant(in.coupling_scale);
    p = hn::MulAdd(s, load(l.sums[kSumCouplingP]), p);
    r = hn::MulAdd(s, load(l.sums[kSumCouplingR]), r);
    sum = hn::MulAdd(s, load(l.sums[kSumCouplingOne]), sum);
    pp = hn::MulAdd(s, load(l.sums[kSumCouplingPp]), pp);
    pr = hn::MulAdd(s, load(l.sums[kSumCouplingPr]), pr);
    rr = hn::MulAdd(s, load(l.sums[kSumCouplingRr]), rr);
  }
  const FloatVec fxx = load(l.splat[kSplatFactor]), fxy = load(l.splat[kSplatFactor + 1]),
                 fyy = load(l.splat[kSplatFactor + 2]), k2 = constant(kTwoLn2);
  const FloatVec dmean_x = hn::Mul(k2, hn::Mul(fxx, p)), dmean_y = hn::Mul(k2, hn::MulAdd(fxy, p, hn::Mul(fyy, r)));
  const FloatVec half = constant(0.5f * kTwoLn2 * kTwoLn2), two = constant(2.0f), one = constant(1.0f);
  const FloatVec row_p = hn::MulAdd(fxy, pp, hn::Mul(fyy, pr)), row_r = hn::MulAdd(fxy, pr, hn::Mul(fyy, rr));
  const FloatVec dxx = hn::Mul(half, hn::Mul(hn::Mul(fxx, fxx), pp));
  const FloatVec dxy = hn::Mul(hn::Mul(two, half), hn::Mul(fxx, row_p));
  const FloatVec dyy = hn::Mul(half, hn::MulAdd(fxy, row_p, hn::Mul(fyy, row_r)));
  const FloatVec sigmoid = hn::Mul(constant(1 / in.opacity_factor), load(l.splat[kSplatOpacity]));
  hn::Store(hn::Mul(sum, hn::Sub(one, sigmoid)), d, out.row[kRowOpacityLogit]);  // dL/dopacity = sum / opacity

  const FloatVec zero = hn::Zero(d), zoom_x = hn::Mul(c.fx, f.inverse_z), zoom_y = hn::Mul(c.fy, f.inverse_z);
  FloatVec daxes[9];
  FloatVec dslope_x = zero, dslope_y = zero, dz = zero;
  for (int k = 0; k < 3; ++k) {
    const FloatVec du = hn::MulAdd(hn::Mul(two, dxx), f.u[k], hn::Mul(dxy, f.v[k]));
    const FloatVec dv = hn::MulAdd(hn::Mul(two, dyy), f.v[k], hn::Mul(dxy, f.u[k]));
    const FloatVec dscale = hn::MulAdd(du, f.u[k], hn::Mul(dv, f.v[k]));
    hn::Store(dscale, d, out.row[kRowLogScale + k]);
    dz = hn::NegMulAdd(dscale, f.inverse_z, dz);
    const FloatVec gu = hn::Mul(hn::Mul(du, f.scale[k]), zoom_x), gv = hn::Mul(hn::Mul(dv, f.scale[k]), zoom_y);
    daxes[k] = gu;
    daxes[3 + k] = gv;
    daxes[6 + k] = hn::Neg(hn::MulAdd(gu, f.slope_x, hn::Mul(gv, f.slope_y)));
    dslope_x = hn::NegMulAdd(gu, f.axes[6 + k], dslope_x);
    dslope_y = hn::NegMulAdd(gv, f.axes[6 + k], dslope_y);
  }
  const FloatVec gx = hn::MulAdd(f.free_x, dslope_x, hn::Mul(dmean_x, c.fx));
  const FloatVec gy = hn::MulAdd(f.free_y, dslope_y, hn::Mul(dmean_y, c.fy));
  Lanes3 dcentre{hn::Mul(gx, f.inverse_z), hn::Mul(gy, f.inverse_z), dz};
  dcentre.z = hn::NegMulAdd(hn::MulAdd(gx, f.raw_slope_x, hn::Mul(gy, f.raw_slope_y)), f.inverse_z, dcentre.z);

  // Plane: d = -n . p_c, n = +-V(:, axis).
  const Lanes3 normal{load(l.splat[kSplatNormal]), load(l.splat[kSplatNormal + 1]), load(l.splat[kSplatNormal + 2])};
  const FloatVec ddistance = load(l.sums[kSumDistance]);
  const Lanes3 dnormal{hn::NegMulAdd(ddistance, centre.x, load(l.sums[kSumNormal])),
                       hn::NegMulAdd(ddistance, centre.y, load(l.sums[kSumNormal + 1])),
                       hn::NegMulAdd(ddistance, centre.z, load(l.sums[kSumNormal + 2]))};
  dcentre = {hn::NegMulAdd(ddistance, normal.x, dcentre.x), hn::NegMulAdd(ddistance, normal.y, dcentre.y),
             hn::NegMulAdd(ddistance, normal.z, dcentre.z)};
  const auto is_1 = hn::Lt(g.log_scale.y, g.log_scale.x);
  const auto is_2 = hn::Lt(g.log_scale.z, hn::Min(g.log_scale.x, g.log_scale.y));
  const auto is_0 = hn::Not(hn::Or(is_1, is_2));
  const FloatVec sign =
      hn::IfThenElse(hn::Ge(dot(normal, select_column(f.axes, is_1, is_2)), zero), one, constant(-1.0f));
  const FloatVec signed_normal[3] = {hn::Mul(sign, dnormal.x), hn::Mul(sign, dnormal.y), hn::Mul(sign, dnormal.z)};
  for (int i = 0; i < 3; ++i) {
    daxes[3 * i] = hn::Add(daxes[3 * i], hn::IfThenElseZero(is_0, signed_normal[i]));
    daxes[3 * i + 1] = hn::Add(daxes[3 * i + 1], hn::IfThenElseZero(hn::AndNot(is_2, is_1), signed_normal[i]));
    daxes[3 * i + 2] = hn::Add(daxes[3 * i + 2], hn::IfThenElseZero(is_2, signed_normal[i]));
  }
  FloatVec drotation[9], quaternion[4];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      drotation[3 * i + k] = dot3(c.r[i], daxes[k], c.r[3 + i], daxes[3 + k], c.r[6 + i], daxes[6 + k]);
    }
  }
  rotation_lanes(f, drotation, quaternion);
  for (int k = 0; k < 4; ++k) hn::Store(quaternion[k], d, out.row[kRowRotation + k]);

  // Colour: dL/dsh and, through the direction, dL/dposition.
  Lanes3 ray{hn::Sub(g.position.x, c.centre[0]), hn::Sub(g.position.y, c.centre[1]),
             hn::Sub(g.position.z, c.centre[2])};
  const FloatVec length = hn::Sqrt(dot(ray, ray));
  const FloatVec inverse = hn::IfThenElseZero(hn::Gt(length, zero), hn::Div(one, length));
  ray = scaled(ray, inverse);
  FloatVec basis[kShCoefficients], weight[kShCoefficients], dcolor[3];
  lane_sh_basis(in.sh_degree, ray, basis);
  for (int ch = 0; ch < 3; ++ch) {
    const FloatVec color = load(l.splat[kSplatColor + static_cast<size_t>(ch)]);
    dcolor[ch] = hn::IfThenElseZero(hn::Gt(color, zero), load(l.sums[kSumColor + ch]));
  }
  for (int k = 0; k < sh_coefficient_count(in.sh_degree); ++k) {
    weight[k] = zero;
    for (int ch = 0; ch < 3; ++ch) {
      hn::Store(hn::Mul(dcolor[ch], basis[k]), d, out.sh[3 * k + ch]);
      weight[k] = hn::MulAdd(dcolor[ch], load(l.sh[3 * k + ch]), weight[k]);
    }
  }
  const Lanes3 ddirection = lane_sh_basis_gradient(in.sh_degree, ray, weight);
  const FloatVec along = dot(ddirection, ray);
  const auto position = [&](int row, FloatVec direction, FloatVec axis) HWY_ATTR {
    const FloatVec world = dot3(c.r[row], dcentre.x, c.r[3 + row], dcentre.y, c.r[6 + row], dcentre.z);
    return hn::MulAdd(hn::NegMulAdd(along, axis, direction), inverse, world);
  };
  hn::Store(position(0, ddirection.x, ray.x), d, out.row[kRowPosition]);
  hn::Store(position(1, ddirection.y, ray.y), d, out.row[kRowPosition + 1]);
  hn::Store(position(2, ddirection.z, ray.z), d, out.row[kRowPosition + 2]);
}

void ProjectBackwardRows(const ProjectBackwardInputs& in, const uint32_t* rows, const CoupledSplatGradient* sums,
                         size_t count, RowGradient* gradients, float* sh_gradients) {
  static_assert(sizeof(RowGradient) == 11 * sizeof(float));
  LaneInputs inputs;
  LaneOutputs outputs;
  const size_t used = static_cast<size_t>(3 * sh_coefficient_count(in.sh_degree));
  for (size_t first = 0; first < count; first += kLanes) {
    const size_t n = HWY_MIN(kLanes, count - first);
    load_lanes(in, rows + first, sums + first, n, inputs);
    backward_lanes(in, inputs, outputs);
    float* sh[kLanes] = {};
    for (size_t lane = 0; lane < n; ++lane) {
      float* to = reinterpret_cast<float*>(gradients + first + lane);
      for (size_t j = 0; j < 11; ++j) to[j] = outputs.row[j][lane];
      sh[lane] = sh_gradients + size_t(rows[first + lane]) * 3 * kShCoefficients;
    }
    for (size_t j = used; j < 3 * kShCoefficients; ++j) hn::Store(hn::Zero(FloatTag()), FloatTag(), outputs.sh[j]);
    lanes_to_rows(outputs.sh, 3 * kShCoefficients, n, sh);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs::cpu {

HWY_EXPORT(ProjectBackwardRows);

void project_backward_rows(const ProjectBackwardInputs& in, const uint32_t* rows, const CoupledSplatGradient* sums,
                           size_t count, RowGradient* gradients, float* sh_gradients) {
  HWY_DYNAMIC_DISPATCH(ProjectBackwardRows)(in, rows, sums, count, gradients, sh_gradients);
}

}  // namespace aligngs::cpu
#endif
