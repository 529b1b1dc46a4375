// Kernels of semantic_lift.h: one thread per pixel forms the weights of a batch of Gaussians and the teacher's values
// of a sweep of channels. Then one thread per Gaussian and channel adds their products up over the pixels.
#include "engine/cuda/semantic_lift.h"

#include "device/constants.h"
#include "device/launch.h"
#include "engine/cuda/semantic_pixel.cuh"
#include "engine/cuda/tile_batch.cuh"
#include "engine/formulas/semantic_start.h"
#include "engine/formulas/teacher_sampling.h"
#include "engine/formulas/whitened.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cuda {

inline constexpr int kLiftStride = kTilePixels + 1;  ///< rows of numbers per pixel begin in different banks
static_assert(kLiftBatch * kLiftChannels == kTilePixels, "one sum per thread");

struct LiftTile {
  Splat splats[kLiftBatch];
  float weights[kLiftBatch][kLiftStride];
  float teacher[kLiftChannels][kLiftStride];
};

__device__ inline void sample_channels(const LiftInputs& in, int x, int y, bool valid, int sweep, int width,
                                       LiftTile& shared) {
  const TeacherSpans& t = in.teacher;
  TeacherTaps taps;
  if (valid) taps = teacher_taps(t.grid(), x, y, in.view.width, in.view.height);
  for (int c = 0; c < kLiftChannels; ++c) {
    float sum = 0;
    for (int k = 0; k < 4 && c < width; ++k) {
      if (taps.weight[k] == 0) continue;
      const size_t at = static_cast<size_t>(taps.pixel[k]) * static_cast<size_t>(t.stride);
      sum += taps.weight[k] * load_half(t.probabilities[at + static_cast<size_t>(sweep + c)]);
    }
    shared.teacher[c][threadIdx.x] = sum;
  }
}

/// slots[slot][c] = sum over the tile's pixels of w t at channels sweep + c.
__global__ void __launch_bounds__(kTilePixels) lift_tiles(LiftInputs in, int sweep, DeviceSpan<float> slots) {
  __shared__ LiftTile shared;
  const ViewSpans& view = in.view;
  const int tile_x = static_cast<int>(blockIdx.x), tile_y = static_cast<int>(blockIdx.y);
  const uint32_t tile = blockIdx.y * gridDim.x + blockIdx.x;
  const int pixel = static_cast<int>(threadIdx.x), strip = static_cast<int>(warp_index());
  const int x = tile_x * kTileSize + tile_pixel_x(pixel), y = tile_y * kTileSize + tile_pixel_y(pixel);
  const bool inside = x < view.width && y < view.height;
  const float pixel_x = static_cast<float>(x) + 0.5f, pixel_y = static_cast<float>(y) + 0.5f;
  const uint32_t begin = in.lists.tile_begin[tile], end = in.lists.tile_begin[tile + 1];
  const uint32_t last = in.record.last[size_t(tile) * kTilePixels + threadIdx.x];
  const int width = std::min(int(kLiftChannels), in.teacher.channels - sweep);
  const size_t u = inside ? static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x) : 0;
  const bool valid = inside && in.teacher.top_class[u] != kNoLabel;
  sample_channels(in, x, y, valid, sweep, width, shared);

  float transmittance = 1;
  for (uint32_t first = begin; first < end; first += kLiftBatch) {
    const uint32_t count = std::min<uint32_t>(kLiftBatch, end - first);
    __syncthreads();
    if (threadIdx.x < count) shared.splats[threadIdx.x] = view.splats[in.lists.gaussians[first + threadIdx.x]];
    __syncthreads();
    for (uint32_t k = 0; k < kLiftBatch; ++k) {
      float weight = 0;
      if (k < count && first - begin + k < last && (in.record.strips[first + k] >> strip & 1u) != 0) {
        const WhitenedAlpha a = whitened_alpha(shared.splats[k], pixel_x, pixel_y, in.raster);
        if (a.wanted) {
          weight = a.alpha * transmittance;
          transmittance = std::fma(-a.alpha, transmittance, transmittance);
        }
      }
      shared.weights[k][threadIdx.x] = valid ? weight : 0.0f;
    }
    __syncthreads();
    const uint32_t k = threadIdx.x / kLiftChannels;
    const int c = static_cast<int>(threadIdx.x % kLiftChannels);
    if (k >= count) continue;
    float sum = 0;
    for (int i = 0; i < kTilePixels; ++i) sum = std::fma(shared.weights[k][i], shared.teacher[c][i], sum);
    const size_t slot = static_cast<size_t>(shared.splats[k].slot(tile_x, tile_y));
    slots[slot * kLiftChannels + static_cast<size_t>(c)] = sum;
  }
}

/// One thread per row and channel of the sweep.
__global__ void __launch_bounds__(kRowThreads)
    add_slots(TileListSpans lists, DeviceSpan<const float> slots, int sweep, int channels, DeviceSpan<float> sums) {
  const size_t i = item_index(), row = i / kLiftChannels;
  const int c = sweep + static_cast<int>(i % kLiftChannels);
  if (row + 1 >= lists.slot_begin.size || c >= channels) return;
  float sum = 0;
  for (size_t slot = lists.slot_begin[row]; slot < lists.slot_begin[row + 1]; ++slot) {
    sum += slots[slot * kLiftChannels + i % kLiftChannels];
  }
  sums[row * static_cast<size_t>(channels) + static_cast<size_t>(c)] += sum;
}

__global__ void __launch_bounds__(kRowThreads)
    start_rows(DeviceSpan<const float> sums, int remainder, ModelSpans model) {
  const size_t i = item_index(), channels = static_cast<size_t>(model.channels);
  if (i >= model.gaussians) return;
  const float* row = sums.data + i * channels;
  float mass = 0;
  for (size_t c = 0; c < channels; ++c) mass += row[c];
  if (mass > 0) semantic_start(row, model.channels, remainder, model.semantics.data + i * channels);
}

void add_teacher_sums(DeviceArena& arena, const LiftInputs& in, DeviceSpan<float> sums) {
  const DeviceContext& context = arena.context();
  const DeviceSpan<float> slots =
      arena.take<float>(in.lists.gaussians.size * kLiftChannels, "teacher sums of (Gaussian, tile) pairs");
  const LaunchShape shape{dim3(static_cast<unsigned>(in.view.tiles_x), static_cast<unsigned>(in.view.tiles_y)),
                          dim3(kTilePixels), 0};
  const size_t rows = in.lists.slot_begin.size - 1;
  for (int sweep = 0; sweep < in.teacher.channels; sweep += kLiftChannels) {
    launch(context, "lift_tiles", lift_tiles, shape, in, sweep, slots);
    launch(context, "add_slots", add_slots, one_per_item(rows * kLiftChannels, kRowThreads), in.lists, slots, sweep,
           in.teacher.channels, sums);
  }
}

void start_semantic_rows(const DeviceContext& context, DeviceSpan<const float> sums, int remainder,
                         const ModelSpans& model) {
  launch(context, "start_rows", start_rows, one_per_item(model.gaussians, kRowThreads), sums, remainder, model);
}

}  // namespace aligngs::cuda
