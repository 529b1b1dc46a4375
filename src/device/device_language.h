// The language of kernels. Under nvcc: CUDA. With ALIGNGS_CUDA_EMULATED the same sources are compiled as plain C++. The
// part of CUDA that this engine uses then runs on the emulation of its execution model (emulation/emulation.h).
//
// Mathematical functions are std::exp, std::min, ... (constexpr or device overloads exist for both). Masks of warp
// operations name lanes that exist and have not returned. Blocks are a multiple of 32 threads. Static shared memory is
// plain __shared__; dynamic shared memory is dynamic_shared<T>().
#pragma once

#ifndef ALIGNGS_CUDA_EMULATED

#include <cuda_bf16.h>
#include <cuda_runtime.h>

namespace aligngs::cuda {

using Bf16 = __nv_bfloat16;
__device__ __forceinline__ Bf16 to_bf16(float f) { return __float2bfloat16(f); }
__device__ __forceinline__ float to_float(Bf16 b) { return __bfloat162float(b); }

/// The block's dynamic shared memory, from `offset` bytes on.
template <class T>
__device__ __forceinline__ T* dynamic_shared(size_t offset = 0) {
  extern __shared__ __align__(128) unsigned char aligngs_dynamic_shared[];
  return reinterpret_cast<T*>(aligngs_dynamic_shared + offset);
}

}  // namespace aligngs::cuda

#else

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/half.h"
#include "device/emulation/emulation.h"

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __noinline__
#define __launch_bounds__(...)
#define __restrict__ __restrict
#define __align__(n) alignas(n)
// All fibers of a block share one thread of the host, and one block runs at a time.
#define __shared__ static thread_local
#define __constant__ static const

using dim3 = aligngs::cuda::EmulatedShape;
#define threadIdx (::aligngs::cuda::emulated_thread)
#define blockIdx (::aligngs::cuda::emulated_block)
#define blockDim (::aligngs::cuda::emulated_block_shape)
#define gridDim (::aligngs::cuda::emulated_grid_shape)
constexpr int warpSize = aligngs::cuda::kEmulatedWarp;

// The vector types of CUDA with its alignments.
struct alignas(8) float2 {
  float x, y;
};
struct float3 {
  float x, y, z;
};
struct alignas(16) float4 {
  float x, y, z, w;
};
struct alignas(8) int2 {
  int x, y;
};
struct alignas(16) int4 {
  int x, y, z, w;
};
struct alignas(8) uint2 {
  unsigned x, y;
};
struct alignas(16) uint4 {
  unsigned x, y, z, w;
};
inline float2 make_float2(float x, float y) { return {x, y}; }
inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }
inline int2 make_int2(int x, int y) { return {x, y}; }
inline uint2 make_uint2(unsigned x, unsigned y) { return {x, y}; }
inline uint4 make_uint4(unsigned x, unsigned y, unsigned z, unsigned w) { return {x, y, z, w}; }

inline void __syncthreads() { aligngs::cuda::emulated_barrier(false); }
inline int __syncthreads_count(int p) { return aligngs::cuda::emulated_barrier(p != 0); }
inline int __syncthreads_or(int p) { return __syncthreads_count(p) > 0; }
inline int __syncthreads_and(int p) { return __syncthreads_count(p == 0) == 0; }
inline void __threadfence() {}
inline void __threadfence_block() {}

namespace aligngs::cuda {

/// Tells the operations of a warp apart, so that lanes in different ones are found.
enum WarpOperation {
  kSyncWarp,
  kShuffle,
  kShuffleUp,
  kShuffleDown,
  kShuffleXor,
  kBallot,
  kReduceAdd,
  kReduceMin,
  kReduceMax,
  kReduceOr,
  kTileProduct
};

template <class T>
struct ShuffleLane {
  T value;
  int source;  ///< lane whose value this lane gets
  T result;
};

template <class T>
void complete_shuffle(void* const* payloads) {
  for (int i = 0; i < kEmulatedWarp; ++i) {
    auto* lane = static_cast<ShuffleLane<T>*>(payloads[i]);
    if (lane == nullptr) continue;
    // The value of a lane outside the mask is undefined on a device: 0xFF (NaN) here.
    const auto* source = static_cast<const ShuffleLane<T>*>(payloads[lane->source]);
    if (source != nullptr) {
      lane->result = source->value;
    } else {
      std::memset(static_cast<void*>(&lane->result), 0xFF, sizeof(T));
    }
  }
}

template <class T>
T emulated_shuffle(unsigned mask, T value, int source, int kind) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 8);
  ShuffleLane<T> lane{value, source, value};
  emulated_collective(mask, kind, &lane, complete_shuffle<T>);
  return lane.result;
}

/// Source lane within groups of `width` lanes; out of the group: the lane itself.
inline int within_group(int lane, int source, int width) {
  const int first = lane & ~(width - 1);
  return source >= first && source < first + width ? source : lane;
}

struct VoteLane {
  uint32_t value, result;
};
template <class Combine>
uint32_t emulated_vote(unsigned mask, uint32_t value, int kind, const Combine&) {
  VoteLane lane{value, 0};
  emulated_collective(mask, kind, &lane, [](void* const* payloads) {
    uint32_t sum = Combine::start();
    for (int i = 0; i < kEmulatedWarp; ++i) {
      if (payloads[i] != nullptr) sum = Combine::next(sum, i, static_cast<VoteLane*>(payloads[i])->value);
    }
    for (int i = 0; i < kEmulatedWarp; ++i) {
      if (payloads[i] != nullptr) static_cast<VoteLane*>(payloads[i])->result = sum;
    }
  });
  return lane.result;
}
struct BallotCombine {
  static uint32_t start() { return 0; }
  static uint32_t next(uint32_t a, int lane, uint32_t b) { return b != 0 ? a | 1u << lane : a; }
};
struct AddCombine {
  static uint32_t start() { return 0; }
  static uint32_t next(uint32_t a, int, uint32_t b) { return a + b; }
};
struct MinCombine {
  static uint32_t start() { return UINT32_MAX; }
  static uint32_t next(uint32_t a, int, uint32_t b) { return std::min(a, b); }
};
struct MaxCombine {
  static uint32_t start() { return 0; }
  static uint32_t next(uint32_t a, int, uint32_t b) { return std::max(a, b); }
};
struct OrCombine {
  static uint32_t start() { return 0; }
  static uint32_t next(uint32_t a, int, uint32_t b) { return a | b; }
};

/// bfloat16 as the device has it: 16 bits, rounded to nearest even.
struct Bf16 {
  uint16_t bits;
};
inline Bf16 to_bf16(float f) { return {float_to_bfloat16(f)}; }
inline float to_float(Bf16 b) { return bfloat16_to_float(b.bits); }

template <class T>
T* dynamic_shared(size_t offset = 0) {
  return reinterpret_cast<T*>(static_cast<unsigned char*>(emulated_shared_memory()) + offset);
}

}  // namespace aligngs::cuda

inline void __syncwarp(unsigned mask = 0xffffffffu) {
  aligngs::cuda::emulated_collective(mask, aligngs::cuda::kSyncWarp, nullptr, nullptr);
}
template <class T>
T __shfl_sync(unsigned mask, T value, int source, int width = 32) {
  const int first = aligngs::cuda::emulated_lane() & ~(width - 1);
  return aligngs::cuda::emulated_shuffle(mask, value, first + (source & (width - 1)), aligngs::cuda::kShuffle);
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, int width = 32) {
  const int lane = aligngs::cuda::emulated_lane();
  return aligngs::cuda::emulated_shuffle(mask, value, aligngs::cuda::within_group(lane, lane - int(delta), width),
                                         aligngs::cuda::kShuffleUp);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, int width = 32) {
  const int lane = aligngs::cuda::emulated_lane();
  return aligngs::cuda::emulated_shuffle(mask, value, aligngs::cuda::within_group(lane, lane + int(delta), width),
                                         aligngs::cuda::kShuffleDown);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int lane_mask, int width = 32) {
  const int lane = aligngs::cuda::emulated_lane();
  return aligngs::cuda::emulated_shuffle(mask, value, aligngs::cuda::within_group(lane, lane ^ lane_mask, width),
                                         aligngs::cuda::kShuffleXor);
}
inline unsigned __ballot_sync(unsigned mask, int p) {
  return aligngs::cuda::emulated_vote(mask, p != 0, aligngs::cuda::kBallot, aligngs::cuda::BallotCombine{});
}
inline int __any_sync(unsigned mask, int p) { return __ballot_sync(mask, p) != 0; }
inline int __all_sync(unsigned mask, int p) { return __ballot_sync(mask, p == 0) == 0; }
inline unsigned __reduce_add_sync(unsigned mask, unsigned v) {
  return aligngs::cuda::emulated_vote(mask, v, aligngs::cuda::kReduceAdd, aligngs::cuda::AddCombine{});
}
inline unsigned __reduce_min_sync(unsigned mask, unsigned v) {
  return aligngs::cuda::emulated_vote(mask, v, aligngs::cuda::kReduceMin, aligngs::cuda::MinCombine{});
}
inline unsigned __reduce_max_sync(unsigned mask, unsigned v) {
  return aligngs::cuda::emulated_vote(mask, v, aligngs::cuda::kReduceMax, aligngs::cuda::MaxCombine{});
}
inline unsigned __reduce_or_sync(unsigned mask, unsigned v) {
  return aligngs::cuda::emulated_vote(mask, v, aligngs::cuda::kReduceOr, aligngs::cuda::OrCombine{});
}

// One thread of the host runs everything, so atomics are plain updates.
template <class T>
T atomicAdd(T* p, std::type_identity_t<T> v) {
  const T old = *p;
  *p = old + v;
  return old;
}
template <class T>
T atomicMax(T* p, std::type_identity_t<T> v) {
  const T old = *p;
  *p = std::max(old, v);
  return old;
}
template <class T>
T atomicMin(T* p, std::type_identity_t<T> v) {
  const T old = *p;
  *p = std::min(old, v);
  return old;
}
template <class T>
T atomicOr(T* p, std::type_identity_t<T> v) {
  const T old = *p;
  *p = old | v;
  return old;
}
template <class T>
T atomicExch(T* p, std::type_identity_t<T> v) {
  const T old = *p;
  *p = v;
  return old;
}
template <class T>
T atomicCAS(T* p, std::type_identity_t<T> compare, std::type_identity_t<T> v) {
  const T old = *p;
  if (old == compare) *p = v;
  return old;
}

template <class T>
T __ldg(const T* p) {
  return *p;
}
inline float __expf(float x) { return std::exp(x); }
inline float __logf(float x) { return std::log(x); }
inline float __fdividef(float a, float b) { return a / b; }
inline float __frcp_rn(float a) { return 1.0f / a; }
inline float rsqrtf(float x) { return 1.0f / std::sqrt(x); }
inline float __saturatef(float x) { return x > 0.0f ? std::min(x, 1.0f) : 0.0f; }
inline int __popc(unsigned x) { return __builtin_popcount(x); }
inline int __ffs(int x) { return __builtin_ffs(x); }
inline int __clz(int x) { return x == 0 ? 32 : __builtin_clz(static_cast<unsigned>(x)); }
template <class To, class From>
To emulated_bits(From from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}
inline unsigned __float_as_uint(float f) { return emulated_bits<unsigned>(f); }
inline int __float_as_int(float f) { return emulated_bits<int>(f); }
inline float __uint_as_float(unsigned u) { return emulated_bits<float>(u); }
inline float __int_as_float(int i) { return emulated_bits<float>(i); }

#endif
