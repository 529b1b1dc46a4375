#include "engine/cuda/memory_forecast.h"

#include <algorithm>

#include "device/constants.h"
#include "engine/cuda/blend_backward.h"
#include "engine/cuda/density.h"
#include "engine/cuda/map_losses.h"
#include "engine/cuda/model_arrays.h"
#include "engine/cuda/parameter_gradients.h"
#include "engine/cuda/semantic_rows.h"
#include "engine/cuda/semantic_visit.h"
#include "engine/cuda/view_spans.h"

namespace aligngs::cuda {
namespace {

constexpr uint64_t kFloat = sizeof(float), kIndex = sizeof(uint32_t);
constexpr uint64_t kSortScratch = 2 * kIndex;  ///< of a radix sort, per pair of key and value: its other buffer

constexpr uint64_t kDensityStatistics = sizeof(DensitySpans) / sizeof(DeviceSpan<float>);

/// An eighth of a step is lost between the blocks of an arena that is not warm yet.
constexpr uint64_t kLostShare = 8;

/// Bytes of the model's rows on their way through a step.
uint64_t row_bytes(uint64_t channels) {
  const uint64_t projected = sizeof(Splat) + sizeof(TileRect) + kFloat;  // radius
  const uint64_t lists = 2 * kIndex + 4 * kIndex + kSortScratch;         // slots, ranks; depths sorted with their rows
  const uint64_t sums = sizeof(DensitySums) + 2 * sizeof(uint8_t);       // touched, written
  const uint64_t statistics = kDensityStatistics * kFloat;
  uint64_t semantics = 0;
  if (channels > 0) {
    const uint64_t padded = static_cast<uint64_t>(padded_channels(static_cast<int>(channels)));
    semantics = padded * (sizeof(uint16_t) + kFloat);  // rows in bfloat16, gradients by rank
  }
  return projected + lists + sums + statistics + semantics;
}

/// Bytes of a (Gaussian, tile) pair.
uint64_t pair_bytes(uint64_t channels, bool checkpoints) {
  // Tile and row, sorted and not; strips, seen.
  const uint64_t lists = 4 * kIndex + kSortScratch + 2 * sizeof(uint8_t);
  uint64_t slots = sizeof(SplatGradient);
  if (channels > 0) {
    slots += sizeof(CouplingMoments) + sizeof(uint8_t) +
             static_cast<uint64_t>(padded_channels(static_cast<int>(channels))) * kFloat;
  }
  const uint64_t pixels = kTilePixels / kCheckpointPlaces;
  return lists + slots + (checkpoints ? pixels * (sizeof(BlendCheckpoint) + sizeof(PlaneCheckpoint)) : 0);
}

/// Bytes of the current view's pixels: maps, their gradients, residual, blend record, scratch of the losses.
uint64_t pixel_bytes(uint64_t pixels) {
  LossSettings all;
  for (const LossRow& row : kLossCatalogue) all.weight[row.loss] = 1;
  const uint64_t neighbour = 1;  // its depth, which stays while the step's own maps are made
  return pixels * (10 + 8 + 1 + 2 + neighbour) * kFloat + map_loss_scratch_bytes(all, pixels);
}

}  // namespace

uint64_t forecast_bytes(const MemoryForecastInputs& in) {
  const uint64_t n = in.gaussians, channels = static_cast<uint64_t>(std::max(0, in.channels));
  const uint64_t model = ModelArrays::bytes(in.gaussians, in.channels);
  const uint64_t numbers = ModelArrays::bytes(in.gaussians, 0);  // gradients of semantics are kept by rank
  const uint64_t state = 3 * model;                              // parameters and two moments
  const uint64_t step = numbers + n * row_bytes(channels) +
                        (n * kPairsPerGaussian + kPairSlack) * pair_bytes(channels, in.checkpoints) +
                        pixel_bytes(in.pixels_per_view);
  return state + step + step / kLostShare;
}

}  // namespace aligngs::cuda
