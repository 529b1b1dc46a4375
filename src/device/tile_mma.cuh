// Products of 16 x 16 blocks in bfloat16 with float32 sums, formed by a warp: mma.m16n8k16 on tensor cores, loops
// under emulation. All 32 lanes call every function together.
//
// The layout of the lanes is part of the interface (PTX ISA, fragments of mma.m16n8k16). A warp can hence work on the
// sums in registers. TileSum::value[i] of a lane is element (row_of(i), column_of(i)).
#pragma once

#include "core/error.h"
#include "device/block_reduce.cuh"
#include "device/device_language.h"

namespace aligngs::cuda {

constexpr int kMmaTile = 16;

/// 16 x 16 float32 sums: 8 per lane.
struct TileSum {
  float value[8];

  __device__ __forceinline__ void clear() {
    for (float& v : value) v = 0.0f;
  }
  __device__ __forceinline__ static int row_of(int i) {
    return static_cast<int>(lane_index() >> 2) + ((i >> 1) & 1) * 8;
  }
  __device__ __forceinline__ static int column_of(int i) {
    return static_cast<int>(lane_index() & 3u) * 2 + (i & 1) + (i >> 2) * 8;
  }
};

/// A 16 x 16 left (rows x depth) or right (depth x columns) operand: 8 bfloat16 per lane, packed in pairs.
struct TileOperand {
  uint32_t pair[4];
};

__device__ __forceinline__ uint32_t pack_bf16(float low, float high) {
#ifdef ALIGNGS_CUDA_EMULATED
  return uint32_t(to_bf16(low).bits) | uint32_t(to_bf16(high).bits) << 16;
#else
  const __nv_bfloat162 both = __floats2bfloat162_rn(low, high);
  return *reinterpret_cast<const uint32_t*>(&both);
#endif
}

/// Sums of one product as the left operand of the next, rounded to bfloat16.
__device__ __forceinline__ TileOperand left_operand(const TileSum& sum) {
  return {{pack_bf16(sum.value[0], sum.value[1]), pack_bf16(sum.value[2], sum.value[3]),
           pack_bf16(sum.value[4], sum.value[5]), pack_bf16(sum.value[6], sum.value[7])}};
}

#ifndef ALIGNGS_CUDA_EMULATED

template <bool kTransposed>
__device__ __forceinline__ TileOperand load_matrices(const Bf16* address) {
  TileOperand t;
  const uint32_t shared = static_cast<uint32_t>(__cvta_generic_to_shared(address));
  if (kTransposed) {
    asm volatile("ldmatrix.sync.aligned.m8n8.x4.trans.shared.b16 {%0, %1, %2, %3}, [%4];"
                 : "=r"(t.pair[0]), "=r"(t.pair[1]), "=r"(t.pair[2]), "=r"(t.pair[3])
                 : "r"(shared)
                 : "memory");
  } else {
    asm volatile("ldmatrix.sync.aligned.m8n8.x4.shared.b16 {%0, %1, %2, %3}, [%4];"
                 : "=r"(t.pair[0]), "=r"(t.pair[1]), "=r"(t.pair[2]), "=r"(t.pair[3])
                 : "r"(shared)
                 : "memory");
  }
  return t;
}

/// The left operand A with A(row, k) = memory[row * stride + k]. Shared memory, 16-byte aligned, stride (elements) a
/// multiple of 8; an odd multiple of 8 avoids bank conflicts. The same holds for the other loads.
__device__ __forceinline__ TileOperand load_left(const Bf16* memory, int stride) {
  const int lane = static_cast<int>(lane_index());
  return load_matrices<false>(memory + ((lane & 7) + ((lane >> 3) & 1) * 8) * stride + (lane >> 4) * 8);
}
/// A(row, k) = memory[k * stride + row].
__device__ __forceinline__ TileOperand load_left_transposed(const Bf16* memory, int stride) {
  const int lane = static_cast<int>(lane_index());
  return load_matrices<true>(memory + ((lane & 7) + (lane >> 4) * 8) * stride + ((lane >> 3) & 1) * 8);
}
/// The right operand B with B(k, column) = memory[k * stride + column].
__device__ __forceinline__ TileOperand load_right(const Bf16* memory, int stride) {
  const int lane = static_cast<int>(lane_index());
  return load_matrices<true>(memory + ((lane & 7) + ((lane >> 3) & 1) * 8) * stride + (lane >> 4) * 8);
}
/// B(k, column) = memory[column * stride + k].
__device__ __forceinline__ TileOperand load_right_transposed(const Bf16* memory, int stride) {
  const int lane = static_cast<int>(lane_index());
  return load_matrices<false>(memory + ((lane & 7) + (lane >> 4) * 8) * stride + ((lane >> 3) & 1) * 8);
}

/// sum += left * right.
__device__ __forceinline__ void multiply_add(TileSum& sum, const TileOperand& left, const TileOperand& right) {
  for (int half = 0; half < 2; ++half) {
    float* c = sum.value + half * 4;
    asm volatile(
        "mma.sync.aligned.m16n8k16.row.col.f32.bf16.bf16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, "
        "{%0, %1, %2, %3};"
        : "+f"(c[0]), "+f"(c[1]), "+f"(c[2]), "+f"(c[3])
        : "r"(left.pair[0]), "r"(left.pair[1]), "r"(left.pair[2]), "r"(left.pair[3]), "r"(right.pair[half * 2]),
          "r"(right.pair[half * 2 + 1]));
  }
}

#else

/// Row and depth of the two elements in pair p of a left operand: (row, k), (row, k + 1).
inline int left_row(int lane, int p) { return (lane >> 2) + (p & 1) * 8; }
inline int left_depth(int lane, int p) { return (lane & 3) * 2 + (p >> 1) * 8; }
/// Column and depth of pair p of a right operand: (k, column), (k + 1, column).
inline int right_column(int lane, int p) { return (lane >> 2) + (p >> 1) * 8; }
inline int right_depth(int lane, int p) { return (lane & 3) * 2 + (p & 1) * 8; }

template <class At>
TileOperand emulated_load(const Bf16* memory, int stride, const At& at) {
  if (reinterpret_cast<uintptr_t>(memory) % 16 != 0 || stride % 8 != 0) {
    throw Error({ErrorKind::kFailed, "operand of a tile product that is not aligned to 16 bytes", {}, {}, {}});
  }
  TileOperand t;
  for (int p = 0; p < 4; ++p) t.pair[p] = uint32_t(at(p, 0).bits) | uint32_t(at(p, 1).bits) << 16;
  __syncwarp();
  return t;
}
inline TileOperand load_left(const Bf16* memory, int stride) {
  const int lane = emulated_lane();
  return emulated_load(memory, stride,
                       [&](int p, int i) { return memory[left_row(lane, p) * stride + left_depth(lane, p) + i]; });
}
inline TileOperand load_left_transposed(const Bf16* memory, int stride) {
  const int lane = emulated_lane();
  return emulated_load(memory, stride,
                       [&](int p, int i) { return memory[(left_depth(lane, p) + i) * stride + left_row(lane, p)]; });
}
inline TileOperand load_right(const Bf16* memory, int stride) {
  const int lane = emulated_lane();
  return emulated_load(memory, stride, [&](int p, int i) {
    return memory[(right_depth(lane, p) + i) * stride + right_column(lane, p)];
  });
}
inline TileOperand load_right_transposed(const Bf16* memory, int stride) {
  const int lane = emulated_lane();
  return emulated_load(memory, stride,
                       [&](int p, int i) { return memory[right_column(lane, p) * stride + right_depth(lane, p) + i]; });
}

struct TileProductLane {
  TileSum* sum;
  const TileOperand *left, *right;
};

inline float operand_element(const TileOperand& t, int p, int i) {
  return bfloat16_to_float(static_cast<uint16_t>(t.pair[p] >> (16 * i)));
}

inline void complete_tile_product(void* const* payloads) {
  float a[kMmaTile][kMmaTile], b[kMmaTile][kMmaTile];
  for (int lane = 0; lane < kEmulatedWarp; ++lane) {
    const auto& l = *static_cast<const TileProductLane*>(payloads[lane]);
    for (int p = 0; p < 4; ++p) {
      for (int i = 0; i < 2; ++i) {
        a[left_row(lane, p)][left_depth(lane, p) + i] = operand_element(*l.left, p, i);
        b[right_depth(lane, p) + i][right_column(lane, p)] = operand_element(*l.right, p, i);
      }
    }
  }
  for (int lane = 0; lane < kEmulatedWarp; ++lane) {
    float* value = static_cast<TileProductLane*>(payloads[lane])->sum->value;
    for (int i = 0; i < 8; ++i) {
      const int row = (lane >> 2) + ((i >> 1) & 1) * 8, column = (lane & 3) * 2 + (i & 1) + (i >> 2) * 8;
      for (int k = 0; k < kMmaTile; ++k) value[i] += a[row][k] * b[k][column];
    }
  }
}

inline void multiply_add(TileSum& sum, const TileOperand& left, const TileOperand& right) {
  TileProductLane lane{&sum, &left, &right};
  emulated_collective(kFullWarp, kTileProduct, &lane, complete_tile_product);
}

#endif

}  // namespace aligngs::cuda
