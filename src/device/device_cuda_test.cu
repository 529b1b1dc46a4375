// The runtime on whatever it is built for: a device, or its emulation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/half.h"
#include "core/random.h"
#include "device/block_reduce.cuh"
#include "device/launch.h"
#include "device/sort_scan.h"
#include "device/testing/device.h"
#include "device/tile_mma.cuh"
#include "device/tolerances.h"

namespace aligngs::cuda {
namespace {

class CudaRuntime : public DeviceTest {};

__global__ void warp_operations(DeviceSpan<int> out) {
  const int lane = static_cast<int>(lane_index());
  int* row = &out[size_t(lane) * 8];
  row[0] = __shfl_sync(kFullWarp, lane, 7);
  row[1] = __shfl_up_sync(kFullWarp, lane, 2);
  row[2] = __shfl_down_sync(kFullWarp, lane, 2);
  row[3] = __shfl_xor_sync(kFullWarp, lane, 5);
  row[4] = __popc(__ballot_sync(kFullWarp, lane % 3 == 0));
  row[5] = __any_sync(kFullWarp, lane == 9) + 2 * __all_sync(kFullWarp, lane < 31);
  row[6] = static_cast<int>(__reduce_max_sync(kFullWarp, static_cast<unsigned>(lane * 2)));
  row[7] = __shfl_xor_sync(kFullWarp, lane, 1, 8) + __shfl_sync(kFullWarp, lane, 3, 8);
}

TEST_F(CudaRuntime, WarpOperations) {
  DeviceArray<int> out(context(), 32 * 8, "test");
  launch(context(), "warp_operations", warp_operations, {dim3(1), dim3(32)}, out.span());
  const std::vector<int> v = out.to_host();
  for (int lane = 0; lane < 32; ++lane) {
    const int* row = &v[static_cast<size_t>(lane) * 8];
    EXPECT_EQ(row[0], 7);
    EXPECT_EQ(row[1], lane < 2 ? lane : lane - 2);
    EXPECT_EQ(row[2], lane > 29 ? lane : lane + 2);
    EXPECT_EQ(row[3], lane ^ 5);
    EXPECT_EQ(row[4], 11);
    EXPECT_EQ(row[5], 1);
    EXPECT_EQ(row[6], 62);
    EXPECT_EQ(row[7], (lane ^ 1) + lane / 8 * 8 + 3);
  }
}

__global__ void sum_blocks(DeviceSpan<const float> in, DeviceSpan<float> out) {
  __shared__ float scratch[32];
  const float sum = block_sum(in[item_index()], scratch);
  out[item_index()] = sum;
}

TEST_F(CudaRuntime, BlockSumReachesEveryThread) {
  std::vector<float> in(3 * 96);
  float expected[3] = {};
  for (size_t i = 0; i < in.size(); ++i) {
    in[i] = static_cast<float>(i % 17);
    expected[i / 96] += in[i];
  }
  DeviceArray<float> device_in, out(context(), in.size(), "test");
  device_in.assign(context(), in, "test");
  launch(context(), "sum_blocks", sum_blocks, {dim3(3), dim3(96)}, device_in.span(), out.span());
  const std::vector<float> v = out.to_host();
  for (size_t i = 0; i < v.size(); ++i) EXPECT_EQ(v[i], expected[i / 96]);
}

__global__ void dynamic_memory(DeviceSpan<int> out) {
  int* first = dynamic_shared<int>();
  int* second = dynamic_shared<int>(32 * sizeof(int));
  first[threadIdx.x] = static_cast<int>(threadIdx.x);
  second[threadIdx.x] = 100;
  __syncthreads();
  out[threadIdx.x] = first[31 - threadIdx.x] + second[threadIdx.x];
}

TEST_F(CudaRuntime, DynamicSharedMemory) {
  DeviceArray<int> out(context(), 32, "test");
  launch(context(), "dynamic_memory", dynamic_memory, {dim3(1), dim3(32), 64 * sizeof(int)}, out.span());
  const std::vector<int> v = out.to_host();
  for (int i = 0; i < 32; ++i) EXPECT_EQ(v[static_cast<size_t>(i)], 131 - i);
}

enum class Operands { kPlain, kTransposed };

constexpr int kStride = 24;  // 16 elements and a gap, as kernels use it

template <Operands kLeft, Operands kRight>
__global__ void product(DeviceSpan<const float> left, DeviceSpan<const float> right, DeviceSpan<float> out) {
  Bf16* a = dynamic_shared<Bf16>();
  Bf16* b = dynamic_shared<Bf16>(kMmaTile * kStride * sizeof(Bf16));
  for (int i = static_cast<int>(threadIdx.x); i < 256; i += 32) {
    a[i / 16 * kStride + i % 16] = to_bf16(left[i]);
    b[i / 16 * kStride + i % 16] = to_bf16(right[i]);
  }
  __syncthreads();
  TileSum sum;
  sum.clear();
  const TileOperand l = kLeft == Operands::kPlain ? load_left(a, kStride) : load_left_transposed(a, kStride);
  const TileOperand r = kRight == Operands::kPlain ? load_right(b, kStride) : load_right_transposed(b, kStride);
  multiply_add(sum, l, r);
  multiply_add(sum, l, r);
  for (int i = 0; i < 8; ++i) out[TileSum::row_of(i) * 16 + TileSum::column_of(i)] = sum.value[i];
}

class CudaTileProduct : public CudaRuntime {
 protected:
  template <Operands kLeft, Operands kRight>
  void check() {
    Random random(5);
    std::vector<float> a(256), b(256);
    for (float& v : a) v = static_cast<float>(random.uniform(-1, 1));
    for (float& v : b) v = static_cast<float>(random.uniform(-1, 1));
    DeviceArray<float> left, right, out(context(), 256, "test");
    left.assign(context(), a, "test");
    right.assign(context(), b, "test");
    launch(context(), "product", product<kLeft, kRight>, {dim3(1), dim3(32), 2 * kMmaTile * kStride * sizeof(Bf16)},
           left.span(), right.span(), out.span());
    const std::vector<float> v = out.to_host();
    const auto rounded = [](float f) { return bfloat16_to_float(float_to_bfloat16(f)); };
    for (size_t row = 0; row < 16; ++row) {
      for (size_t column = 0; column < 16; ++column) {
        double expected = 0;
        for (size_t k = 0; k < 16; ++k) {
          expected += 2.0 * rounded(kLeft == Operands::kPlain ? a[row * 16 + k] : a[k * 16 + row]) *
                      rounded(kRight == Operands::kPlain ? b[k * 16 + column] : b[column * 16 + k]);
        }
        EXPECT_NEAR(v[row * 16 + column], expected, CudaTolerance().tile_product);
      }
    }
  }
};

TEST_F(CudaTileProduct, PlainOperands) { check<Operands::kPlain, Operands::kPlain>(); }
TEST_F(CudaTileProduct, TransposedLeft) { check<Operands::kTransposed, Operands::kPlain>(); }
TEST_F(CudaTileProduct, TransposedRight) { check<Operands::kPlain, Operands::kTransposed>(); }

/// (A I) B: the sums of the first product are the left operand of the second.
__global__ void chained_product(DeviceSpan<const float> left, DeviceSpan<float> out) {
  Bf16* a = dynamic_shared<Bf16>();
  Bf16* unit = dynamic_shared<Bf16>(kMmaTile * kStride * sizeof(Bf16));
  for (int i = static_cast<int>(threadIdx.x); i < 256; i += 32) {
    a[i / 16 * kStride + i % 16] = to_bf16(left[i]);
    unit[i / 16 * kStride + i % 16] = to_bf16(i / 16 == i % 16 ? 1.0f : 0.0f);
  }
  __syncthreads();
  TileSum first, second;
  first.clear();
  second.clear();
  multiply_add(first, load_left(a, kStride), load_right(unit, kStride));
  multiply_add(second, left_operand(first), load_right(unit, kStride));
  for (int i = 0; i < 8; ++i) out[TileSum::row_of(i) * 16 + TileSum::column_of(i)] = second.value[i];
}

TEST_F(CudaTileProduct, SumsAsLeftOperand) {
  std::vector<float> a(256);
  for (size_t i = 0; i < 256; ++i) a[i] = static_cast<float>(i);  // exact in bfloat16
  DeviceArray<float> left, out(context(), 256, "test");
  left.assign(context(), a, "test");
  launch(context(), "chained_product", chained_product, {dim3(1), dim3(32), 2 * kMmaTile * kStride * sizeof(Bf16)},
         left.span(), out.span());
  EXPECT_EQ(out.to_host(), a);
}

TEST_F(CudaRuntime, SortIsStableAndLooksOnlyAtTheLowestBits) {
  const std::vector<uint32_t> keys = {5, 0x80000001u, 3, 1, 5, 0};
  DeviceArray<uint32_t> in, values, out_keys(context(), 6, "test"), out_values(context(), 6, "test");
  in.assign(context(), keys, "test");
  values.assign(context(), {0, 1, 2, 3, 4, 5}, "test");
  DeviceArena arena(context());
  sort_pairs(arena, in.span(), values.span(), out_keys.span(), out_values.span(), 8);
  EXPECT_THAT(out_values.to_host(), testing::ElementsAre(5, 1, 3, 2, 0, 4));
}

TEST_F(CudaRuntime, SortsKeysOf64Bits) {
  DeviceArray<uint64_t> in, out_keys(context(), 3, "test");
  DeviceArray<uint32_t> values, out_values(context(), 3, "test");
  in.assign(context(), {uint64_t(1) << 40, 7, uint64_t(1) << 39}, "test");
  values.assign(context(), {10, 11, 12}, "test");
  DeviceArena arena(context());
  sort_pairs(arena, in.span(), values.span(), out_keys.span(), out_values.span(), 64);
  EXPECT_THAT(out_values.to_host(), testing::ElementsAre(11, 12, 10));
}

TEST_F(CudaRuntime, ScanInPlace) {
  DeviceArray<uint32_t> values;
  values.assign(context(), {3, 0, 4, 1}, "test");
  DeviceArena arena(context());
  exclusive_scan(arena, values.span(), values.span());
  EXPECT_THAT(values.to_host(), testing::ElementsAre(0, 3, 3, 7));
}

TEST_F(CudaRuntime, BudgetIsKeptAndSaysWhatDidNotFit) {
  DeviceContext small(context().device(), 1 << 20);
  DeviceArray<float> fits(small, 1000, "a little");
  try {
    DeviceArray<float> too_much(small, 1 << 20, "the Gaussians");
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.what(), testing::HasSubstr("the Gaussians: 4 MB wanted"));
  }
  EXPECT_EQ(small.used(), 4000u);
}

constexpr size_t kMegabyte = size_t(1) << 20;

class CudaArena : public CudaRuntime {
 protected:
  /// Allocations that `body` makes.
  template <class Body>
  uint64_t allocations(const Body& body) {
    const uint64_t before = context().allocations();
    body();
    return context().allocations() - before;
  }
};

TEST_F(CudaArena, OnceWarmOneBlockServesEveryStepAtTheSameAddresses) {
  DeviceArena arena(context());
  std::vector<unsigned char*> places;
  const auto step = [&] {
    places.clear();
    arena.reset();
    for (const size_t bytes : {3 * kMegabyte, size_t(100), 5 * kMegabyte}) {
      places.push_back(arena.take<unsigned char>(bytes, "test").data);
    }
  };
  EXPECT_EQ(allocations(step), 3u);  // 3 MB, as much again, 5 MB
  EXPECT_EQ(allocations(step), 1u);
  const std::vector<unsigned char*> warm = places;
  EXPECT_EQ(allocations(step), 0u);
  EXPECT_EQ(places, warm);
  EXPECT_LT(context().used(), 10 * kMegabyte) << "the blocks of the first step are gone";
}

TEST_F(CudaArena, PiecesAreAlignedAndDoNotOverlap) {
  DeviceArena arena(context());
  const DeviceSpan<unsigned char> a = arena.take<unsigned char>(257, "a"), b = arena.take<unsigned char>(1, "b");
  EXPECT_EQ(reinterpret_cast<uintptr_t>(a.data) % 256, 0u);
  EXPECT_EQ(b.data - a.data, 512);
  EXPECT_EQ(arena.take<float>(0, "nothing").data, nullptr);
}

TEST_F(CudaArena, WhatIsTakenLaterLeavesEarlierPiecesWhereTheyAre) {
  DeviceArena arena(context());
  const std::vector<float> values = {1, 2, 3};
  const DeviceSpan<float> early = arena.take<float>(3, "early");
  upload(context(), early, values.data());
  (void)arena.take_zeroed<float>(kMegabyte, "late");
  std::vector<float> found(3);
  download(context(), found.data(), early);
  EXPECT_EQ(found, values);
}

TEST_F(CudaArena, AStepThatTakesMoreIsWarmAfterOneMore) {
  DeviceArena arena(context());
  const auto step = [&](size_t megabytes) {
    return allocations([&] {
      arena.reset();
      (void)arena.take<unsigned char>(megabytes * kMegabyte, "test");
      (void)arena.take<unsigned char>(megabytes * kMegabyte, "test");
    });
  };
  step(8);
  EXPECT_EQ(step(8), 1u);
  EXPECT_EQ(step(9), 0u) << "an eighth to spare";
  EXPECT_EQ(step(5), 0u);
  EXPECT_EQ(step(12), 1u);
  EXPECT_EQ(step(12), 1u);
  EXPECT_EQ(step(12), 0u);
}

TEST_F(CudaArena, TakesTheWholeBudgetAndNotMore) {
  DeviceContext small(context().device(), 10 * kMegabyte);
  DeviceArena arena(small);
  for (int repeat = 0; repeat < 3; ++repeat) {
    arena.reset();
    for (const size_t megabytes : {3, 2, 5}) (void)arena.take<unsigned char>(megabytes * kMegabyte, "test");
    EXPECT_EQ(small.used(), 10 * kMegabyte);
  }
  try {
    (void)arena.take<float>(1, "one more");
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.what(), testing::HasSubstr("one more"));
  }
  arena.release();
  EXPECT_EQ(small.used(), 0u);
}

TEST_F(CudaArena, WhatAnEarlierStepWroteIsForgotten) {
  if (!kEmulated) GTEST_SKIP() << "on a device it stays";
  DeviceArena arena(context());
  (void)arena.take_zeroed<float>(4, "test");
  arena.reset();
  std::vector<float> found(4);
  download(context(), found.data(), arena.take<float>(4, "test"));
  for (const float v : found) EXPECT_TRUE(std::isnan(v));
}

TEST_F(CudaRuntime, WaitingIsCounted) {
  DeviceArray<float> array(context(), 4, "test");
  const uint64_t before = context().synchronisations();
  fill_zero(context(), array.span());
  EXPECT_EQ(context().synchronisations(), before);
  (void)array.to_host();
  EXPECT_EQ(context().synchronisations(), before + 1);
}

}  // namespace
}  // namespace aligngs::cuda
