// Steps of the kernel of semantic_visit.cu for one block of pixels:
//   forwards, a few Gaussians at a time: weights W to shared memory in bfloat16, P += W^T S in registers;
//   P to shared memory, the loss by one warp per pixel, dP and H in bfloat16 into the place of P;
//   backwards, a few Gaussians at a time: weights again, Q = S H^T, the sweep from the back, dS = W dP.
#pragma once

#include "engine/cuda/semantic_pixel.cuh"
#include "engine/cuda/semantic_tile.cuh"

namespace aligngs::cuda {

/// P = W^T S of block b to shared memory; returns what is left behind the last Gaussian at this thread's pixel.
/// A warp forms one row of tiles of 16 x 16, or every kColumnParts-th of it.
template <class Form, int kGroups>
__device__ __forceinline__ float blend_rows(const Visit<Form>& v, int b, uint32_t pixel_last) {
  constexpr int kColumns = kGroups * (kWarp / kMmaTile) / Form::kColumnParts;
  TileSum sums[kColumns];
#pragma unroll
  for (int g = 0; g < kColumns; ++g) sums[g].clear();
  const int pixel_tile = v.warp % Form::kPixelTiles, column_part = v.warp / Form::kPixelTiles;
  const int columns = v.layout.padded / kMmaTile;
  float t = 1;
  for (uint32_t first = 0; first < v.end; first += kVisitBatch) {
    const int count = list_entries(v, b, first);
    for (int at = 0; at < count; at += Form::kEntries) {
      const int n = count - at < Form::kEntries ? count - at : Form::kEntries;
      load_entries(v, b, at, n);
      load_rows(v, n);
      const PartAlphas<Form> a = part_alphas(v, b, n, pixel_last);
      __syncthreads();
      float before[Form::kPartEntries];
      part_weights(v, a, t, before);
      t *= chunk_product(v);
      __syncthreads();
      for (int step = 0; step < Form::kEntries && step < n; step += kMmaTile) {
        const TileOperand left =
            load_left_transposed(v.s.weights + step * Form::kWeightStride + pixel_tile * kMmaTile, Form::kWeightStride);
#pragma unroll
        for (int g = 0; g < kColumns; ++g) {
          const int column = column_part + Form::kColumnParts * g;
          if (column >= columns) continue;
          const int stride = v.layout.row_stride();
          multiply_add(sums[g], left, load_right(v.rows + step * stride + column * kMmaTile, stride));
        }
      }
      __syncthreads();
    }
  }
#pragma unroll
  for (int g = 0; g < kColumns; ++g) {
    const int column = column_part + Form::kColumnParts * g;
    if (column >= columns) continue;
    for (int k = 0; k < 8; ++k) {
      const int row = pixel_tile * kMmaTile + TileSum::row_of(k);
      v.blended[row * v.layout.blended_stride() + column * kMmaTile + TileSum::column_of(k)] = sums[g].value[k];
    }
  }
  if (v.part() == 0) v.s.transmittance[v.pixel()] = t;
  __syncthreads();
  return t;
}

/// The loss of block b in place: row i of blended becomes dP and, with the bounded coupling, H, in bfloat16. Adds to
/// the terms of this warp, which takes as many pixels as every other.
template <class Form, int kGroups>
__device__ __forceinline__ void block_loss(const Visit<Form>& v, int b, double& soft, double& hard) {
  constexpr int kPixels = Form::kPixels / Form::kWarps;
  const ChannelSet set{v.in.teacher.channels, v.in.remainder};
  const bool bounded = v.in.couple && is_balanced(v.in.coupling);
  const bool opacity = v.in.coupling == SemanticCoupling::kOpacity;
  const int padded = v.layout.padded;
  PixelTeacher mine;
  mine.top = -1;
  if (v.lane < kPixels) {
    const int i = b * Form::kPixels + v.warp * kPixels + v.lane;
    mine = find_teacher(v.in, v.tile_x * kTileSize + tile_pixel_x(i), v.tile_y * kTileSize + tile_pixel_y(i));
  }
  for (int k = 0; k < kPixels; ++k) {
    const int pixel = v.warp * kPixels + k;
    PixelTeacher px = share_teacher(mine, k);
    const float push = opacity ? px.omega : 0;
    if (opacity) px.omega = 0;
    float* blended = v.blended + pixel * v.layout.blended_stride();
    PixelChannels<kGroups> row;
    PixelLoss loss{0, 0, 0};
#pragma unroll
    for (int g = 0; g < kGroups; ++g) {
      row.value[g] = lane_channel(g) < padded ? blended[lane_channel(g)] : 0.0f;
    }
    if (px.top >= 0) {
      float t[kGroups];
      sample_teacher_lanes(v.in.teacher, px, t);
      const float alpha = 1 - v.s.transmittance[pixel];
      loss = v.in.blend == SemanticBlend::kProbabilities ? probabilities_loss(v.in, set, px, t, alpha, bounded, row)
                                                         : logits_loss(v.in, set, px, t, alpha, bounded, row);
      loss.offset += push;
    } else {
#pragma unroll
      for (int g = 0; g < kGroups; ++g) row.value[g] = row.direction[g] = 0;
    }
    __syncwarp();  // every lane has read its channels
    Bf16* to = v.gradient_rows() + pixel * v.gradient_stride();
#pragma unroll
    for (int g = 0; g < kGroups; ++g) {
      const int c = lane_channel(g);
      if (c >= padded) continue;
      to[c] = to_bf16(row.value[g]);
      if (bounded) to[padded + c] = to_bf16(row.direction[g]);
    }
    if (v.lane == 0) {
      v.s.offset[pixel] = loss.offset;
      soft += static_cast<double>(loss.soft);
      hard += static_cast<double>(loss.hard);
    }
  }
  __syncthreads();
}

/// q of the loaded entries, [entry][pixel]: Q = S H^T - h_0, a tile per warp at a time. Ends with a barrier.
template <class Form>
__device__ __forceinline__ void coupling_values(const Visit<Form>& v) {
  const int stride = v.layout.row_stride();
  const bool bounded = is_balanced(v.in.coupling);
  const Bf16* direction = v.gradient_rows() + (bounded ? v.layout.padded : 0);
#pragma unroll
  for (int tile = v.warp; tile < Form::kEntryTiles * Form::kPixelTiles; tile += Form::kWarps) {
    const int entry_tile = tile / Form::kPixelTiles, pixel_tile = tile % Form::kPixelTiles;
    TileSum q;
    q.clear();
    for (int c = 0; c < v.layout.padded; c += kMmaTile) {
      const TileOperand left = load_left(v.rows + entry_tile * kMmaTile * stride + c, stride);
      const Bf16* right = direction + pixel_tile * kMmaTile * v.gradient_stride() + c;
      multiply_add(q, left, load_right_transposed(right, v.gradient_stride()));
    }
    for (int k = 0; k < 8; ++k) {
      const int entry = entry_tile * kMmaTile + TileSum::row_of(k);
      const int pixel = pixel_tile * kMmaTile + TileSum::column_of(k);
      v.s.coupling[entry * Form::kCouplingStride + pixel] = q.value[k] - v.s.offset[pixel];
    }
  }
  __syncthreads();
}

/// From q to g in place. `behind` moves from the blend behind the loaded entries to that behind the entries before.
/// Ends with a barrier.
template <class Form>
__device__ __forceinline__ void coupling_sweep(const Visit<Form>& v, const PartAlphas<Form>& a,
                                               const float (&before)[Form::kPartEntries], float& behind) {
  float* q = v.s.coupling + v.part() * Form::kPartEntries * Form::kCouplingStride + v.pixel();
  float alone = 0;
#pragma unroll
  for (int k = Form::kPartEntries - 1; k >= 0; --k) alone += a.alpha[k] * (q[k * Form::kCouplingStride] - alone);
  v.s.behind[v.part()][v.pixel()] = alone;
  __syncthreads();
  float back = behind;
  for (int p = Form::kParts - 1; p > v.part(); --p) {
    back = v.s.behind[p][v.pixel()] + v.s.products[p][v.pixel()] * back;
  }
#pragma unroll
  for (int k = Form::kPartEntries - 1; k >= 0; --k) {
    const float step = q[k * Form::kCouplingStride] - back;
    back += a.alpha[k] * step;
    q[k * Form::kCouplingStride] = a.slope[k] * before[k] * step;
  }
  for (int p = Form::kParts - 1; p >= 0; --p) behind = v.s.behind[p][v.pixel()] + v.s.products[p][v.pixel()] * behind;
  __syncthreads();
}

/// Moments of g of the loaded entries into their slots. A warp takes as many entries as every other.
template <class Form>
__device__ __forceinline__ void coupling_moments(const Visit<Form>& v, int b, int n) {
  constexpr int kEntries = Form::kEntries / Form::kWarps, kFields = sizeof(CouplingMoments) / sizeof(float);
  static_assert(kEntries >= 1 && kEntries * kFields <= kWarp, "one lane per number");
  const int first = v.warp * kEntries;
  if (first >= n) return;
  float sums[kWarp] = {};
#pragma unroll
  for (int k = 0; k < kEntries; ++k) {
    const int e = first + k;
    if (e >= n) continue;
    const Splat& g = v.s.splats[e];
    WhitenedMoments<float> m;
    for (int pixel = v.lane; pixel < Form::kPixels; pixel += kWarp) {
      const int i = b * Form::kPixels + pixel;
      const float dx = static_cast<float>(v.tile_x * kTileSize + tile_pixel_x(i)) + 0.5f - g.x;
      const float dy = static_cast<float>(v.tile_y * kTileSize + tile_pixel_y(i)) + 0.5f - g.y;
      add_moment(v.s.coupling[e * Form::kCouplingStride + pixel], g.fxx * dx + g.fxy * dy, g.fyy * dy, m);
    }
    sums[kFields * k] = m.p;
    sums[kFields * k + 1] = m.r;
    sums[kFields * k + 2] = m.one;
    sums[kFields * k + 3] = m.pp;
    sums[kFields * k + 4] = m.pr;
    sums[kFields * k + 5] = m.rr;
  }
  const float sum = warp_sums(sums);
  const int e = first + v.lane / kFields;
  if (e >= n || v.lane >= kEntries * kFields) return;
  float* to = reinterpret_cast<float*>(&v.out.coupling[v.s.entry_slot[e]]) + v.lane % kFields;
  *to = v.s.entry_first[e] != 0 ? sum : *to + sum;
}

/// dS = W dP of the loaded entries into their slots, 16 at a time. Begins and ends with a barrier.
template <class Form>
__device__ __forceinline__ void row_gradients(const Visit<Form>& v, int n) {
  const int columns = v.layout.padded / kMmaTile, stride = v.layout.blended_stride(), vectors = v.layout.padded / 4;
  for (int first = 0; first < n; first += kSumRows) {
    __syncthreads();  // the rows, or the sums before, have been read
    for (int column = v.warp; column < columns; column += Form::kWarps) {
      TileSum sum;
      sum.clear();
      for (int pixel = 0; pixel < Form::kPixels; pixel += kMmaTile) {
        const TileOperand left = load_left(v.s.weights + first * Form::kWeightStride + pixel, Form::kWeightStride);
        const Bf16* right = v.gradient_rows() + pixel * v.gradient_stride() + column * kMmaTile;
        multiply_add(sum, left, load_right(right, v.gradient_stride()));
      }
      for (int k = 0; k < 8; ++k) {
        v.sums[TileSum::row_of(k) * stride + column * kMmaTile + TileSum::column_of(k)] = sum.value[k];
      }
    }
    __syncthreads();
    for (int row = v.warp; row < kSumRows && first + row < n; row += Form::kWarps) {
      const int e = first + row;
      const bool set = v.s.entry_first[e] != 0;
      const size_t at = size_t(v.s.entry_slot[e]) * static_cast<size_t>(v.layout.padded);
      float4* to = reinterpret_cast<float4*>(&v.out.row_slots[at]);
      for (int k = v.lane; k < vectors; k += kWarp) {
        float4 x = reinterpret_cast<const float4*>(v.sums + row * stride)[k];
        if (!set) {
          const float4 old = to[k];
          x = make_float4(old.x + x.x, old.y + x.y, old.z + x.z, old.w + x.w);
        }
        to[k] = x;
      }
    }
  }
  __syncthreads();
}

/// Gradients of block b after its loss; t is what is left behind the last Gaussian at this thread's pixel.
template <class Form>
__device__ __forceinline__ void block_gradients(const Visit<Form>& v, int b, uint32_t pixel_last, float t) {
  float behind = 0;
  const uint32_t batches = (v.end + kVisitBatch - 1) / kVisitBatch;
  for (uint32_t batch = batches; batch-- > 0;) {
    const int count = list_entries(v, b, batch * kVisitBatch);
    for (int at = (count - 1) / Form::kEntries * Form::kEntries; at >= 0 && count > 0; at -= Form::kEntries) {
      const int n = count - at < Form::kEntries ? count - at : Form::kEntries;
      load_entries(v, b, at, n);
      if (v.in.couple) load_rows(v, n);
      const PartAlphas<Form> a = part_alphas(v, b, n, pixel_last);
      if (v.thread < n && v.s.entry_first[v.thread] != 0) v.out.seen[v.s.entry_slot[v.thread]] = 1;
      __syncthreads();
      t /= chunk_product(v);  // at least transmittance_min, else these would not have been taken
      float before[Form::kPartEntries];
      part_weights(v, a, t, before);
      __syncthreads();
      if (v.in.couple) {
        coupling_values(v);
        coupling_sweep(v, a, before, behind);
        coupling_moments(v, b, n);
      }
      row_gradients(v, n);
    }
  }
}

}  // namespace aligngs::cuda
