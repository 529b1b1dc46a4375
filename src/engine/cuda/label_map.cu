// Kernels of label_map.h: one thread per pixel of a tile goes through the tile's list once per sweep of channels. The
// sweep's sums stay in its registers.
#include "engine/cuda/label_map.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/tile_batch.cuh"
#include "engine/formulas/whitened.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cuda {

inline constexpr float kLabelAlphaMin = 0.5f;  ///< "nothing here" below (engine.h)

__device__ __forceinline__ float class_count(const LabelInputs& in, int channel) {
  return channel + 1 == in.model.channels && in.remainder > 0 ? static_cast<float>(in.remainder) : 1.0f;
}

/// log sum exp of every row, a remainder counted once per class: softmax_c = count exp(s_c - it).
__global__ void __launch_bounds__(kRowThreads) row_log_sums(LabelInputs in, DeviceSpan<float> out) {
  const size_t i = item_index();
  if (i >= in.model.gaussians) return;
  const float* row = in.model.semantics.data + i * static_cast<size_t>(in.model.channels);
  float top = row[0], sum = 0;
  for (int c = 1; c < in.model.channels; ++c) top = std::max(top, row[c]);
  for (int c = 0; c < in.model.channels; ++c) sum += class_count(in, c) * std::exp(row[c] - top);
  out[i] = top + std::log(sum);
}

/// The rows of a batch's Gaussians at the channels of a sweep.
struct LabelBatch {
  TileBatch gaussians;
  float features[kBlendBatch][kChannelSweep];
};

/// The state of a pixel after the channels seen so far.
struct LabelState {
  float best = -3.4e38f, top = -3.4e38f, sum = 0;  ///< sum of count exp(blended - top)
  int channel = 0;

  __device__ __forceinline__ void take(float blended, float count, bool own_class, int index) {
    if (own_class && blended > best) {
      best = blended;
      channel = index;
    }
    if (blended > top) {
      sum = sum * std::exp(top - blended) + count;
      top = blended;
    } else {
      sum += count * std::exp(blended - top);
    }
  }
};

__global__ void __launch_bounds__(kTilePixels)
    label_tiles(LabelInputs in, DeviceSpan<const float> log_sums, LabelOutputs out) {
  __shared__ LabelBatch batch;
  const ViewSpans& view = in.view;
  const uint32_t tile = blockIdx.y * gridDim.x + blockIdx.x;
  const int left = static_cast<int>(blockIdx.x) * kTileSize, top = static_cast<int>(blockIdx.y) * kTileSize;
  const int pixel = static_cast<int>(threadIdx.x), strip = static_cast<int>(warp_index());
  const int x = left + tile_pixel_x(pixel), y = top + tile_pixel_y(pixel);
  const float pixel_x = static_cast<float>(x) + 0.5f, pixel_y = static_cast<float>(y) + 0.5f;
  const uint32_t begin = in.lists.tile_begin[tile], end = in.lists.tile_begin[tile + 1];
  const uint32_t last = in.record.last[size_t(tile) * kTilePixels + threadIdx.x];
  const int channels = in.model.channels, classes = channels - (in.remainder > 0 ? 1 : 0);
  const bool probabilities = in.blend == SemanticBlend::kProbabilities;

  LabelState state;
  for (int sweep = 0; sweep < channels; sweep += kChannelSweep) {
    const int width = std::min(int(kChannelSweep), channels - sweep);
    float blended[kChannelSweep] = {};
    float transmittance = 1;
    for (uint32_t first = begin; first < end; first += kBlendBatch) {
      if (__syncthreads_or(first - begin < last) == 0) break;
      const uint32_t count = std::min<uint32_t>(kBlendBatch, end - first);
      load_batch(view, in.lists, first, count, left, top, batch.gaussians);
      if (threadIdx.x < count) {
        const size_t row = in.lists.gaussians[first + threadIdx.x];
        const float* from = in.model.semantics.data + row * static_cast<size_t>(channels) + sweep;
        for (int c = 0; c < width; ++c) {
          batch.features[threadIdx.x][c] =
              probabilities ? class_count(in, sweep + c) * std::exp(from[c] - log_sums[row]) : from[c];
        }
      }
      __syncthreads();
      for (uint32_t k = 0; k < count && first - begin + k < last; ++k) {
        if ((in.record.strips[first + k] >> strip & 1u) == 0) continue;
        const WhitenedAlpha a = whitened_alpha(batch.gaussians.splats[k], pixel_x, pixel_y, in.raster);
        if (!a.wanted) continue;
        const float weight = a.alpha * transmittance;
        transmittance = std::fma(-a.alpha, transmittance, transmittance);
        for (int c = 0; c < width; ++c) blended[c] = std::fma(weight, batch.features[k][c], blended[c]);
      }
      __syncthreads();
    }
    for (int c = 0; c < width; ++c) {
      state.take(blended[c], class_count(in, sweep + c), sweep + c < classes, sweep + c);
    }
  }
  if (x >= view.width || y >= view.height) return;
  const size_t u = static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
  const float alpha = in.alpha[u];
  out.channel[u] = alpha >= kLabelAlphaMin ? static_cast<uint16_t>(state.channel) : kNoLabel;
  out.probability[u] = probabilities ? state.best + (1.0f - alpha) / static_cast<float>(classes + in.remainder)
                                     : std::exp(state.best - state.top) / state.sum;
}

void label_map(DeviceArena& arena, const LabelInputs& in, const LabelOutputs& out) {
  const DeviceContext& context = arena.context();
  DeviceSpan<float> log_sums;
  if (in.blend == SemanticBlend::kProbabilities) {
    log_sums = arena.take<float>(in.model.gaussians, "sums of semantic rows");
    launch(context, "row_log_sums", row_log_sums, one_per_item(in.model.gaussians, kRowThreads), in, log_sums);
  }
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  launch(context, "label_tiles", label_tiles, shape, in, log_sums, out);
}

}  // namespace aligngs::cuda
