// Guarantees of the emulation: the meaning of barriers and warp operations, and errors where a device would hang.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "core/error.h"
#include "device/block_reduce.cuh"
#include "device/launch.h"

namespace aligngs::cuda {
namespace {

constexpr unsigned kThreads = 64;

__global__ void reverse_in_block(DeviceSpan<int> values) {
  __shared__ int copy[kThreads];
  copy[threadIdx.x] = values[item_index()];
  __syncthreads();
  values[item_index()] = copy[kThreads - 1 - threadIdx.x];
}

__global__ void reverse_without_barrier(DeviceSpan<int> values) {
  __shared__ int copy[kThreads];
  copy[threadIdx.x] = values[item_index()];
  values[item_index()] = copy[kThreads - 1 - threadIdx.x];
}

__global__ void half_meet_at_barrier(int) {
  if (threadIdx.x < 32) __syncthreads();
}

__global__ void return_before_barrier(int) {
  if (threadIdx.x == 3) return;
  __syncthreads();
}

__global__ void lane_missing(int) {
  if (threadIdx.x == 5) return;
  (void)__shfl_xor_sync(kFullWarp, 1, 1);
}

__global__ void lanes_in_different_operations(int) {
  if (threadIdx.x % 2 == 0) {
    (void)__ballot_sync(kFullWarp, 1);
  } else {
    (void)__shfl_sync(kFullWarp, 1, 0);
  }
}

__global__ void write_beyond(DeviceSpan<int> values) { values[values.size + threadIdx.x] = 1; }

std::vector<int> iota(size_t n) {
  std::vector<int> v(n);
  for (size_t i = 0; i < n; ++i) v[i] = static_cast<int>(i);
  return v;
}

std::vector<int> run_on(DeviceContext& context, void (*kernel)(DeviceSpan<int>)) {
  DeviceArray<int> values;
  values.assign(context, iota(2 * kThreads), "test");
  launch(context, "test", kernel, {dim3(2), dim3(kThreads)}, values.span());
  return values.to_host();
}

std::string message_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Emulation, BarrierSeparatesWritesFromReadsInEveryOrder) {
  DeviceContext context(0);
  const auto expected = [&](size_t i) {
    return static_cast<int>(i / kThreads * kThreads + kThreads - 1 - i % kThreads);
  };
  for (const ThreadOrder order : {ThreadOrder::kForward, ThreadOrder::kReverse, ThreadOrder::kShuffled}) {
    const ScopedThreadOrder scope(order, 3);
    const std::vector<int> out = run_on(context, reverse_in_block);
    for (size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i], expected(i));
  }
}

TEST(Emulation, MissingBarrierShowsWhenTheOrderChanges) {
  DeviceContext context(0);
  const std::vector<int> forward = run_on(context, reverse_without_barrier);
  const ScopedThreadOrder scope(ThreadOrder::kReverse);
  EXPECT_NE(run_on(context, reverse_without_barrier), forward);
}

TEST(Emulation, ErrorsInsteadOfHanging) {
  DeviceContext context(0);
  const auto run = [&](void (*kernel)(int)) {
    return message_of([&] { launch(context, "test", kernel, {dim3(1), dim3(kThreads)}, 0); });
  };
  EXPECT_THAT(run(half_meet_at_barrier),
              testing::AnyOf(testing::HasSubstr("have returned"), testing::HasSubstr("no thread can go on")));
  EXPECT_THAT(run(return_before_barrier), testing::HasSubstr("returned"));
  EXPECT_THAT(run(lane_missing), testing::HasSubstr("lane 5, which does not exist or has returned"));
  EXPECT_THAT(run(lanes_in_different_operations), testing::HasSubstr("different warp operations"));
}

TEST(Emulation, WriteBeyondASpanIsAnError) {
  DeviceContext context(0);
  EXPECT_THAT(message_of([&] { (void)run_on(context, write_beyond); }), testing::HasSubstr("index 128"));
}

TEST(Emulation, WorksAgainAfterAnError) {
  DeviceContext context(0);
  EXPECT_THROW(launch(context, "test", lane_missing, {dim3(1), dim3(kThreads)}, 0), Error);
  EXPECT_EQ(run_on(context, reverse_in_block)[0], int(kThreads) - 1);
}

TEST(Emulation, MemoryStartsAsNotANumber) {
  DeviceContext context(0);
  DeviceArray<float> values(context, 3, "test");
  for (const float v : values.to_host()) EXPECT_NE(v, v);
}

}  // namespace
}  // namespace aligngs::cuda
