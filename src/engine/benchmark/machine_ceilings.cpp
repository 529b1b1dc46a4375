#include "engine/benchmark/machine_ceilings.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/matrix_tiles.h"
#include "core/steady_seconds.h"
#include "engine/benchmark/amx_peak.h"
#include "engine/cpu/aligned_array.h"
#include "engine/cpu/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/benchmark/machine_ceilings.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Ten chains hide a latency of four to five cycles on two units. Each begins with a number of its own: the compiler
/// makes one chain of equal ones. Returns the multiply-adds done.
double FmaBurn(size_t rounds, float* result) {
  const HWY_FULL(float) d;
  const auto a = hn::Set(d, 0.999f), b = hn::Set(d, 1e-3f);
  const auto start = [&](int chain) { return hn::Set(d, 1e-3f * static_cast<float>(chain)); };
  auto c0 = start(0), c1 = start(1), c2 = start(2), c3 = start(3), c4 = start(4);
  auto c5 = start(5), c6 = start(6), c7 = start(7), c8 = start(8), c9 = start(9);
  for (size_t i = 0; i < rounds; ++i) {
    c0 = hn::MulAdd(c0, a, b);
    c1 = hn::MulAdd(c1, a, b);
    c2 = hn::MulAdd(c2, a, b);
    c3 = hn::MulAdd(c3, a, b);
    c4 = hn::MulAdd(c4, a, b);
    c5 = hn::MulAdd(c5, a, b);
    c6 = hn::MulAdd(c6, a, b);
    c7 = hn::MulAdd(c7, a, b);
    c8 = hn::MulAdd(c8, a, b);
    c9 = hn::MulAdd(c9, a, b);
  }
  const auto all = hn::Add(hn::Add(hn::Add(c0, c1), hn::Add(c2, c3)), hn::Add(hn::Add(c4, c5), hn::Add(c6, c7)));
  *result = hn::GetLane(hn::Add(all, hn::Add(c8, c9)));
  return 10.0 * static_cast<double>(rounds * hn::Lanes(d));
}

const char* TargetInUse() { return hwy::TargetName(HWY_TARGET); }

float ReadSum(const float* values, size_t count) {
  const HWY_FULL(float) d;
  const size_t step = hn::Lanes(d);
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
  for (size_t i = 0; i + 4 * step <= count; i += 4 * step) {
    s0 = hn::Add(s0, hn::Load(d, values + i));
    s1 = hn::Add(s1, hn::Load(d, values + i + step));
    s2 = hn::Add(s2, hn::Load(d, values + i + 2 * step));
    s3 = hn::Add(s3, hn::Load(d, values + i + 3 * step));
  }
  return hn::GetLane(hn::Add(hn::Add(s0, s1), hn::Add(s2, s3)));
}

void Triad(const float* b, const float* c, size_t count, float* a) {
  const HWY_FULL(float) d;
  const auto scale = hn::Set(d, 0.5f);
  for (size_t i = 0; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    hn::Store(hn::MulAdd(scale, hn::Load(d, c + i), hn::Load(d, b + i)), d, a + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace aligngs {

HWY_EXPORT(FmaBurn);
HWY_EXPORT(TargetInUse);
HWY_EXPORT(ReadSum);
HWY_EXPORT(Triad);

namespace {

constexpr int kRuns = 5;
constexpr size_t kFmaRounds = 2000000;         ///< some 10 ms
constexpr int64_t kAmxRounds = 300000;         ///< some 10 ms
constexpr size_t kElements = size_t(1) << 25;  ///< floats per array: 128 MB, beyond any cache of the day
constexpr size_t kTaskElements = size_t(1) << 20;

double best_seconds(const std::function<void()>& run) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRuns; ++i) {
    const double start = steady_seconds();
    run();
    best = std::min(best, steady_seconds() - start);
  }
  return best;
}

constexpr size_t kParts = 4;  ///< tasks per thread, so that a thread that wakes late costs little

}  // namespace

double measure_fma_gflops(ThreadPool& pool) {
  const size_t parts = static_cast<size_t>(pool.size()) * kParts;
  std::vector<float> results(parts);
  std::vector<double> operations(parts);
  const double seconds = best_seconds([&] {
    pool.parallel_for(parts, 1, [&](size_t i, size_t, int) {
      operations[i] = HWY_DYNAMIC_DISPATCH(FmaBurn)(kFmaRounds / kParts, &results[i]);
    });
  });
  // Reads the results, so that no compiler may leave the computation out.
  double gflops = 0, seen = 0;
  for (const float s : results) seen += static_cast<double>(s);
  for (const double n : operations) gflops += 2 * n / seconds * 1e-9;
  return seen > 0 ? gflops : 0;
}

double measure_amx_gflops(ThreadPool& pool) {
  if (!matrix_tiles_available()) return 0;
  const size_t parts = static_cast<size_t>(pool.size()) * kParts;
  const auto tiles = [](size_t, size_t, int) { amx_burn(kAmxRounds / kParts); };
  const double seconds = best_seconds([&] { pool.parallel_for(parts, 1, tiles); });
  return kAmxOperationsPerRound * static_cast<double>(kAmxRounds * pool.size()) / seconds * 1e-9;
}

MachineCeilings measure_ceilings(ThreadPool& pool, bool matrix_tiles) {
  MachineCeilings out;
  out.instructions = HWY_DYNAMIC_DISPATCH(TargetInUse)();
  out.fma_gflops = measure_fma_gflops(pool);
  if (matrix_tiles) out.amx_gflops = measure_amx_gflops(pool);

  cpu::AlignedArray<float> a, b, c;
  for (cpu::AlignedArray<float>* array : {&a, &b, &c}) array->assign(kElements, 1.0f);
  std::vector<float> sums(kElements / kTaskElements);
  const double read = best_seconds([&] {
    pool.parallel_for(kElements, kTaskElements, [&](size_t begin, size_t end, int) {
      sums[begin / kTaskElements] = HWY_DYNAMIC_DISPATCH(ReadSum)(a.data() + begin, end - begin);
    });
  });
  const double triad = best_seconds([&] {
    pool.parallel_for(kElements, kTaskElements, [&](size_t begin, size_t end, int) {
      HWY_DYNAMIC_DISPATCH(Triad)(b.data() + begin, c.data() + begin, end - begin, a.data() + begin);
    });
  });
  // Reads the results, so that no compiler may leave the computation out.
  double seen = static_cast<double>(a[kElements / 2]);
  for (const float s : sums) seen += static_cast<double>(s);
  const double bytes = static_cast<double>(kElements * sizeof(float));
  out.read_gbps = seen > 0 ? bytes / read * 1e-9 : 0;
  out.triad_gbps = 3 * bytes / triad * 1e-9;
  return out;
}

double floor_seconds(const MachineCeilings& c, double vector_flops, double matrix_flops, double bytes) {
  const double matrix_rate = c.amx_gflops > 0 ? c.amx_gflops : c.fma_gflops;
  return 1e-9 * std::max(vector_flops / c.fma_gflops + matrix_flops / matrix_rate,
                         bytes / std::max(c.read_gbps, c.triad_gbps));
}

}  // namespace aligngs
#endif
