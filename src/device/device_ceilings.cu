// Kernels of device_ceilings.h.
#include "device/device_ceilings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "device/block_reduce.cuh"
#include "device/device_span.h"
#include "device/launch.h"
#include "device/stage_timer.h"
#include "device/tile_mma.cuh"

namespace aligngs::cuda {

inline constexpr unsigned kCeilingThreads = 256;
inline constexpr int kFmaChains = 8;  ///< hide a latency of four cycles on two schedulers' worth of warps
inline constexpr int kMmaChains = 4;  ///< sums of 8 registers each, so that a block's threads fit eightfold
inline constexpr double kFmaOperations = 2.0 * kFmaChains;                                   ///< per thread and round
inline constexpr double kMmaOperations = 2.0 * kMmaTile * kMmaTile * kMmaTile * kMmaChains;  ///< per warp and round

__global__ void __launch_bounds__(kCeilingThreads)
    copy_ceiling_kernel(DeviceSpan<const float4> from, DeviceSpan<float4> to) {
  const size_t step = size_t(gridDim.x) * kCeilingThreads;
  for (size_t i = item_index(); i < from.size; i += step) to[i] = from[i];
}

/// x = a x + b, again and again; the results are kept, so that no compiler may leave it out.
__global__ void __launch_bounds__(kCeilingThreads)
    fma_ceiling_kernel(int rounds, float a, float b, DeviceSpan<float> out) {
  float x[kFmaChains];
#pragma unroll
  for (int k = 0; k < kFmaChains; ++k) x[k] = static_cast<float>(k);
  for (int i = 0; i < rounds; ++i) {
#pragma unroll
    for (int k = 0; k < kFmaChains; ++k) x[k] = std::fma(a, x[k], b);
  }
  float sum = 0;
#pragma unroll
  for (int k = 0; k < kFmaChains; ++k) sum += x[k];
  out[item_index()] = sum;
}

/// A warp adds products of two small operands to its sums.
__global__ void __launch_bounds__(kCeilingThreads)
    mma_ceiling_kernel(int rounds, float a, float b, DeviceSpan<float> out) {
  TileOperand left, right;
  for (int k = 0; k < 4; ++k) {
    left.pair[k] = pack_bf16(a, a);
    right.pair[k] = pack_bf16(b, b);
  }
  TileSum sums[kMmaChains];
#pragma unroll
  for (int k = 0; k < kMmaChains; ++k) sums[k].clear();
  for (int i = 0; i < rounds; ++i) {
#pragma unroll
    for (int k = 0; k < kMmaChains; ++k) multiply_add(sums[k], left, right);
  }
  float total = 0;
#pragma unroll
  for (int k = 0; k < kMmaChains; ++k) {
#pragma unroll
    for (int j = 0; j < 8; ++j) total += sums[k].value[j];
  }
  out[item_index()] = total;
}
namespace {

double best_seconds(const DeviceContext& context, int runs, const std::function<void()>& run) {
  StageTimer timer(context, true);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= runs; ++i) {  // the first one warms the clocks up
    timer.start();
    run();
    timer.mark("run");
    context.synchronise();
    std::map<std::string, double> seconds;
    timer.read(seconds);
    if (i > 0) best = std::min(best, seconds["run"]);
  }
  return best;
}

/// Every entry must be `expected`: a kernel that did less would look fast.
void check_results(const std::vector<float>& results, float expected, const char* what) {
  for (const float r : results) {
    if (std::abs(r - expected) <= 1e-3f * std::abs(expected)) continue;
    throw Error(
        {ErrorKind::kFailed,
         std::string("measuring ") + what + " gave " + std::to_string(r) + " instead of " + std::to_string(expected),
         {},
         {},
         {}});
  }
}

}  // namespace

CeilingEffort usual_effort() {
#ifdef ALIGNGS_CUDA_EMULATED
  return {1 << 16, 10, 1, 1};
#else
  return {};
#endif
}

DeviceCeilings measure_device_ceilings(int device, const CeilingEffort& effort) {
  DeviceContext context(device);
  const unsigned blocks = static_cast<unsigned>(context.facts().multiprocessors * effort.blocks_per_multiprocessor);
  const LaunchShape shape{dim3(blocks), dim3(kCeilingThreads), 0};
  DeviceCeilings out;
  {
    const size_t count = effort.copy_bytes / sizeof(float4);
    DeviceArray<float4> from(context, count, "measuring its memory"), to(context, count, "measuring its memory");
    fill_zero(context, from.span());
    const double seconds = best_seconds(
        context, effort.runs, [&] { launch(context, "copy", copy_ceiling_kernel, shape, from.span(), to.span()); });
    out.copy_gbps = 2e-9 * static_cast<double>(count * sizeof(float4)) / seconds;
  }
  DeviceArray<float> results(context, size_t(blocks) * kCeilingThreads, "measuring its arithmetic");
  const double threads = static_cast<double>(blocks) * kCeilingThreads;
  const double fma = best_seconds(context, effort.runs, [&] {
    launch(context, "fma", fma_ceiling_kernel, shape, effort.rounds, 0.5f, 0.5f, results.span());
  });
  // x -> x / 2 + 1 / 2 goes to 1 from anywhere near, halving the distance in each round.
  float left = 0;
  for (int k = 0; k < kFmaChains; ++k) left += std::ldexp(static_cast<float>(k) - 1.0f, -effort.rounds);
  check_results(results.to_host(), kFmaChains + left, "float32 operations");
  out.fma_gflops = 1e-9 * kFmaOperations * threads * effort.rounds / fma;

  const double mma = best_seconds(context, effort.runs, [&] {
    launch(context, "mma", mma_ceiling_kernel, shape, effort.rounds, 0.25f, 0.25f, results.span());
  });
  // 16 products of 1 / 16 are 1 per round, exact in float32 up to 2^24 rounds.
  check_results(results.to_host(), 8.0f * kMmaChains * static_cast<float>(effort.rounds), "tile products");
  out.mma_gflops = 1e-9 * kMmaOperations * (threads / 32) * effort.rounds / mma;
  return out;
}

}  // namespace aligngs::cuda
