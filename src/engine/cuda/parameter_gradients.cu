// Kernels of parameter_gradients.h.
#include "engine/cuda/parameter_gradients.h"

#include "device/constants.h"
#include "engine/cuda/sum_columns.cuh"
#include "engine/cuda/warp_sums.cuh"
#include "engine/formulas/color.h"
#include "engine/formulas/shape_terms.h"
#include "engine/formulas/whitened.h"
#include "engine/shared/optimiser_settings.h"

namespace aligngs::cuda {

__global__ void mark_touched_kernel(TileListSpans lists, BlendRecordSpans record, DeviceSpan<uint8_t> touched,
                                    DeviceSpan<uint32_t> visible) {
  const size_t i = item_index();
  uint8_t any = 0;
  if (i < touched.size) {
    for (uint32_t slot = lists.slot_begin[i]; slot < lists.slot_begin[i + 1] && any == 0; ++slot) {
      any = record.seen[slot];
    }
    touched[i] = any;
  }
  const unsigned votes = __ballot_sync(kFullWarp, any != 0);
  if (lane_index() == 0 && votes != 0) atomicAdd(&visible[0], static_cast<uint32_t>(__popc(votes)));
}

static_assert(kCoupledSums <= kWarp, "one lane each");
struct SlotSums {
  float v[kWarp] = {};  ///< in the order of SplatSum and CouplingSum
};

__device__ __forceinline__ void add_vector(const float4& x, float* to) {
  to[0] += x.x;
  to[1] += x.y;
  to[2] += x.z;
  to[3] += x.w;
}

__device__ __forceinline__ void add_slot(const ParameterGradientSpans& in, uint32_t slot, SlotSums& sums) {
  if (in.record.seen[slot] == 0) return;
  const float4* main = reinterpret_cast<const float4*>(&in.slots[slot]);
#pragma unroll
  for (int k = 0; k < kSplatGradientFloats / 4; ++k) add_vector(main[k], sums.v + 4 * k);
  if (in.coupling.empty() || in.coupling_seen[slot] == 0) return;
  const CouplingMoments& c = in.coupling[slot];
  sums.v[kSumCouplingP] += c.p;
  sums.v[kSumCouplingR] += c.r;
  sums.v[kSumCouplingOne] += c.one;
  sums.v[kSumCouplingPp] += c.pp;
  sums.v[kSumCouplingPr] += c.pr;
  sums.v[kSumCouplingRr] += c.rr;
}

/// Sums of this thread's row over slots [begin, end), which may be empty. All lanes call it.
__device__ __forceinline__ SlotSums sum_slots(const ParameterGradientSpans& in, uint32_t begin, uint32_t end) {
  const uint32_t lane = lane_index();
  SlotSums sums;
  const bool many = end - begin > kOwnSlots;
  for (uint32_t slot = begin; slot < end && !many; ++slot) add_slot(in, slot, sums);
  for (unsigned rows = __ballot_sync(kFullWarp, many); rows != 0; rows &= rows - 1) {
    const int owner = __ffs(static_cast<int>(rows)) - 1;
    const uint32_t first = __shfl_sync(kFullWarp, begin, owner), last = __shfl_sync(kFullWarp, end, owner);
    SlotSums part;
    for (uint32_t slot = first + lane; slot < last; slot += kWarp) add_slot(in, slot, part);
    const float total = warp_sums(part.v);
#pragma unroll
    for (int k = 0; k < kCoupledSums; ++k) {
      const float x = __shfl_sync(kFullWarp, total, k);
      if (lane == static_cast<uint32_t>(owner)) sums.v[k] = x;
    }
  }
  return sums;
}

/// False for NaN.
__device__ __forceinline__ bool within_limit(float x) { return std::abs(x) <= kGradientLimit; }
__device__ __forceinline__ bool within_limit(const Vec3<float>& v) {
  return within_limit(v.x) && within_limit(v.y) && within_limit(v.z);
}
template <int kCount>
__device__ __forceinline__ bool within_limit(const float (&values)[kCount]) {
  bool good = true;
  for (int k = 0; k < kCount; ++k) good = good && within_limit(values[k]);
  return good;
}

/// From the sums of a touched row to its parameters' gradients.
__device__ __forceinline__ void row_gradients(const ParameterGradientSpans& in, const ParameterGradientOutputs& out,
                                              size_t i, const SlotSums& sums) {
  const float* v = sums.v;
  const Splat& splat = in.view.splats[i];
  const ModelSpans& m = in.model;
  GaussianShape<float> g;
  for (int k = 0; k < 3; ++k) g.position[k] = m.positions[3 * i + k];
  for (int k = 0; k < 3; ++k) g.log_scale[k] = m.log_scales[3 * i + k];
  g.rotation = {m.rotations[4 * i], m.rotations[4 * i + 1], m.rotations[4 * i + 2], m.rotations[4 * i + 3]};

  float p = v[kSumP], r = v[kSumR], one = v[kSumOne], pp = v[kSumPp], pr = v[kSumPr], rr = v[kSumRr];
  if (!in.coupling.empty() && in.coupling_scale != 0) {
    const float s = in.coupling_scale;
    p += s * v[kSumCouplingP];
    r += s * v[kSumCouplingR];
    one += s * v[kSumCouplingOne];
    pp += s * v[kSumCouplingPp];
    pr += s * v[kSumCouplingPr];
    rr += s * v[kSumCouplingRr];
  }
  const WhiteningFactor<float> factor{splat.fxx, splat.fxy, splat.fyy};
  CovarianceGradient<float> d;
  d.mean = whitened_mean_gradient(factor, p, r);
  d.covariance = whitened_covariance_gradient(factor, pp, pr, rr);
  d.opacity = one / splat.opacity;
  d.normal = {v[kSumNormal], v[kSumNormal + 1], v[kSumNormal + 2]};
  d.distance = v[kSumDistance];
  Projection<float> projected;
  projected.opacity = splat.opacity;
  projected.opacity_factor = in.opacity_factor;
  projected.normal = {splat.normal[0], splat.normal[1], splat.normal[2]};
  projected.normal_axis = smallest_axis(g.log_scale);
  ShapeGradient<float> shape = project_backward(g, in.view.camera, projected, d);

  float sh[3 * kShCoefficients] = {};
  const Vec3<float> color{splat.color[0], splat.color[1], splat.color[2]},
      dcolor{v[kSumColor], v[kSumColor + 1], v[kSumColor + 2]};
  shape.position += sh_color_backward(in.sh_degree, g.position, in.view.camera.centre, &m.sh[3 * kShCoefficients * i],
                                      color, dcolor, sh);

  const ModelSpans& to = out.gradients;
  for (int k = 0; k < 3; ++k) to.positions[3 * i + k] = shape.position[k];
  for (int k = 0; k < 3; ++k) to.log_scales[3 * i + k] = shape.log_scale[k];
  for (int k = 0; k < 4; ++k) to.rotations[4 * i + k] = shape.rotation[k];
  to.opacity_logits[i] = shape.opacity_logit;
  for (int k = 0; k < 3 * kShCoefficients; ++k) to.sh[3 * kShCoefficients * i + k] = sh[k];
  if (!out.density.empty()) {
    out.density[i] = {v[kSumPhotometricP], v[kSumPhotometricR], v[kSumPhotometricAbsP], v[kSumPhotometricAbsY],
                      v[kSumWeight],       v[kSumResidual],     v[kSumUnsupported]};
  }

  GradientClass bad = GradientClass::kSemantics;  // the one that is not looked at here
  if (!within_limit(sh)) bad = GradientClass::kSh;
  if (!within_limit(shape.opacity_logit)) bad = GradientClass::kOpacityLogits;
  if (!within_limit(shape.rotation)) bad = GradientClass::kRotations;
  if (!within_limit(shape.log_scale)) bad = GradientClass::kLogScales;
  if (!within_limit(shape.position)) bad = GradientClass::kPositions;
  if (bad != GradientClass::kSemantics) atomicMin(&out.bad[0], bad_gradient_key(i, bad));
}

__device__ __forceinline__ double square_of_mean(const Splat& s, float p, float r) {
  const Vec2<float> mean = whitened_mean_gradient<float>({s.fxx, s.fxy, s.fyy}, p, r);
  return static_cast<double>(mean.x * mean.x + mean.y * mean.y);
}

__global__ void __launch_bounds__(kGradientThreads)
    parameter_gradients_kernel(ParameterGradientSpans in, ParameterGradientOutputs out) {
  __shared__ double scratch[kWarp];
  const size_t i = item_index();
  const bool row = i < in.model.gaussians, touched = row && in.touched[i] != 0;
  const SlotSums sums = sum_slots(in, touched ? in.lists.slot_begin[i] : 0, touched ? in.lists.slot_begin[i + 1] : 0);
  double photometric = 0, coupling = 0;
  if (touched) {
    row_gradients(in, out, i, sums);
    photometric = square_of_mean(in.view.splats[i], sums.v[kSumPhotometricP], sums.v[kSumPhotometricR]);
    coupling = square_of_mean(in.view.splats[i], sums.v[kSumCouplingP], sums.v[kSumCouplingR]);
  } else if (row) {
    for (int k = 0; k < 3; ++k) out.gradients.positions[3 * i + k] = 0;
    for (int k = 0; k < 3; ++k) out.gradients.log_scales[3 * i + k] = 0;
    for (int k = 0; k < 4; ++k) out.gradients.rotations[4 * i + k] = 0;
    out.gradients.opacity_logits[i] = 0;
  }
  photometric = block_sum(photometric, scratch);
  coupling = block_sum(coupling, scratch);
  if (threadIdx.x == 0) {
    double* squares = &out.scratch[size_t(kGradientSquares) * blockIdx.x];
    squares[kPhotometricSquares] = photometric;
    squares[kCouplingSquares] = coupling;
  }
}

void mark_touched(const DeviceContext& context, const TileListSpans& lists, const BlendRecordSpans& record,
                  DeviceSpan<uint8_t> touched, DeviceSpan<uint32_t> visible) {
  fill_zero(context, visible);
  launch(context, "mark_touched", mark_touched_kernel, one_per_item(touched.size, kRowThreads), lists, record, touched,
         visible);
}

size_t square_scratch(size_t gaussians) {
  return kGradientSquares * ((gaussians + kGradientThreads - 1) / kGradientThreads);
}

void parameter_gradients(const DeviceContext& context, const ParameterGradientSpans& in,
                         const ParameterGradientOutputs& out) {
  launch(context, "parameter_gradients", parameter_gradients_kernel, one_per_item(in.model.gaussians, kGradientThreads),
         in, out);
  sum_columns<kGradientSquares>(context, out.scratch.part(0, square_scratch(in.model.gaussians)), 1.0, out.squares);
}

}  // namespace aligngs::cuda
