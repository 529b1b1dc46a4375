// Kernels of semantic_rows.h. One warp per Gaussian; lane l holds channels l, l + 32, ...
#include "engine/cuda/semantic_rows.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/lane_channels.cuh"
#include "engine/cuda/parameter_gradients.h"
#include "engine/shared/optimiser_settings.h"

namespace aligngs::cuda {

__device__ __forceinline__ void load_logits(const SemanticRowInputs& in, size_t row, float (&x)[kLaneChannels]) {
  const size_t first = row * static_cast<size_t>(in.model.channels);
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) {
    const int c = lane_channel(k);
    x[k] = c < in.model.channels ? in.model.semantics[first + static_cast<size_t>(c)] : 0.0f;
  }
}

/// softmax in place of the channels, the last of which represents `remainder` classes; NaN where one is not finite.
__device__ __forceinline__ void softmax_lanes(int channels, int remainder, float (&x)[kLaneChannels]) {
  const float shift = remainder > 1 ? std::log(static_cast<float>(remainder)) : 0.0f;
  float top = -3.0e38f, sum = 0;
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) {
    const int c = lane_channel(k);
    if (c == channels - 1) x[k] += shift;
    if (c < channels) top = x[k] > top ? x[k] : top;
  }
  top = warp_maximum(top);
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) {
    // 0 x is NaN for a logit that is not finite; maximum and exp may hide it.
    const float e = lane_channel(k) < channels ? std::exp(x[k] - top) + 0.0f * x[k] : 0.0f;
    x[k] = e;
    sum += e;
  }
  const float inverse = 1.0f / warp_sum(sum);
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) x[k] *= inverse;
}

__global__ void semantic_rows_kernel(SemanticRowInputs in, DeviceSpan<uint16_t> rows) {
  const size_t row = size_t(blockIdx.x) * kRowWarps + warp_index();
  if (row >= in.model.gaussians || in.touched[row] == 0) return;
  const int channels = in.model.channels, padded = padded_channels(channels);
  float x[kLaneChannels];
  load_logits(in, row, x);
  float mean = 0;
  if (in.blend == SemanticBlend::kProbabilities) {
    softmax_lanes(channels, in.remainder, x);
  } else {
    float sum = 0;
#pragma unroll
    for (int k = 0; k < kLaneChannels; ++k) sum += x[k];
    mean = warp_sum(sum) / static_cast<float>(channels);
  }
  Bf16* to = reinterpret_cast<Bf16*>(&rows[size_t(in.rank[row]) * static_cast<size_t>(padded)]);
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) {
    const int c = lane_channel(k);
    if (c < padded) to[c] = to_bf16(c < channels ? x[k] - mean : 0.0f);
  }
}

/// Adds the seen slots of [begin, end) in their order; true when there is one.
__device__ __forceinline__ bool add_row_slots(const SemanticGradientInputs& in, uint32_t begin, uint32_t end,
                                              int padded, float (&sum)[kLaneChannels]) {
  bool any = false;
  for (uint32_t first = begin; first < end; first += kWarp) {
    const uint32_t mine = first + lane_index();
    unsigned seen = __ballot_sync(kFullWarp, mine < end && in.seen[mine] != 0);
    any = any || seen != 0;
    for (; seen != 0; seen &= seen - 1) {
      const size_t slot = first + static_cast<uint32_t>(__ffs(static_cast<int>(seen)) - 1);
      const size_t at = slot * static_cast<size_t>(padded);
#pragma unroll
      for (int k = 0; k < kLaneChannels; ++k) {
        const int c = lane_channel(k);
        if (c < padded) sum[k] += in.row_slots[at + static_cast<size_t>(c)];
      }
    }
  }
  return any;
}

__global__ void __launch_bounds__(kRowWarps* kWarp)
    semantic_gradients_kernel(SemanticGradientInputs in, SemanticGradientOutputs out) {
  __shared__ uint32_t begins[kRowWarps], ends[kRowWarps];
  __shared__ int anies[kRowWarps];
  __shared__ float parts[kRowWarps][kMaxSemanticChannels];
  const int warp = static_cast<int>(warp_index()), channels = in.rows.model.channels;
  const int padded = padded_channels(channels);
  const size_t row = size_t(blockIdx.x) * kRowWarps + warp_index(), rows = in.rows.model.gaussians;
  const bool touched = row < rows && in.rows.touched[row] != 0;
  const uint32_t begin = touched ? in.lists.slot_begin[row] : 0, end = touched ? in.lists.slot_begin[row + 1] : 0;
  const bool many = end - begin > kWarpSlots;
  float g[kLaneChannels] = {};
  bool any = false;
  if (!many) any = add_row_slots(in, begin, end, padded, g);
  if (lane_index() == 0) {
    begins[warp] = many ? begin : 0;
    ends[warp] = many ? end : 0;
  }
  __syncthreads();
  for (int w = 0; w < kRowWarps; ++w) {
    const uint32_t first = begins[w], last = ends[w];
    if (first == last) continue;
    const uint32_t share = (last - first + kRowWarps - 1) / kRowWarps;
    const uint32_t from = std::min(first + share * static_cast<uint32_t>(warp), last);
    const uint32_t to = std::min(from + share, last);
    float part[kLaneChannels] = {};
    const bool found = add_row_slots(in, from, to, padded, part);
    for (int k = 0; k < kLaneChannels; ++k) parts[warp][lane_channel(k)] = part[k];
    if (lane_index() == 0) anies[warp] = found;
    __syncthreads();
    for (int p = 0; p < kRowWarps && w == warp; ++p) {
      any = any || anies[p] != 0;
#pragma unroll
      for (int k = 0; k < kLaneChannels; ++k) g[k] += parts[p][lane_channel(k)];
    }
    __syncthreads();
  }
  if (row >= rows) return;
  if (lane_index() == 0) out.written[row] = any ? 1 : 0;
  if (!any) return;

  if (in.rows.blend == SemanticBlend::kProbabilities) {  // softmax_backward of formulas/semantic_loss.h
    float pi[kLaneChannels], along = 0;
    load_logits(in.rows, row, pi);
    softmax_lanes(channels, in.rows.remainder, pi);
#pragma unroll
    for (int k = 0; k < kLaneChannels; ++k) along += pi[k] * g[k];
    along = warp_sum(along);
#pragma unroll
    for (int k = 0; k < kLaneChannels; ++k) g[k] = pi[k] * (g[k] - along);
  }
  bool good = true;
  const size_t at = size_t(in.rows.rank[row]) * static_cast<size_t>(padded);
#pragma unroll
  for (int k = 0; k < kLaneChannels; ++k) {
    const int c = lane_channel(k);
    if (c >= padded) continue;
    good = good && (c >= channels || std::abs(g[k]) <= kGradientLimit);
    out.gradients[at + static_cast<size_t>(c)] = c < channels ? g[k] : 0.0f;
  }
  if (!__all_sync(kFullWarp, good) && lane_index() == 0) {
    atomicMin(&out.bad[0], bad_gradient_key(row, GradientClass::kSemantics));
  }
}
namespace {

LaunchShape one_warp_per_row(size_t rows) {
  return {dim3(static_cast<unsigned>((rows + kRowWarps - 1) / kRowWarps)), dim3(kRowWarps * kWarp), 0};
}

}  // namespace

void semantic_rows(const DeviceContext& context, const SemanticRowInputs& in, DeviceSpan<uint16_t> rows) {
  launch(context, "semantic_rows", semantic_rows_kernel, one_warp_per_row(in.model.gaussians), in, rows);
}

void semantic_gradients(const DeviceContext& context, const SemanticGradientInputs& in,
                        const SemanticGradientOutputs& out) {
  launch(context, "semantic_gradients", semantic_gradients_kernel, one_warp_per_row(in.rows.model.gaussians), in, out);
}

}  // namespace aligngs::cuda
