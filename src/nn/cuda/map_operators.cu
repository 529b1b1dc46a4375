// Kernels of map_operators.h: one thread per value of the result.
#include "nn/cuda/map_operators.h"

#include "device/block_reduce.cuh"
#include "device/constants.h"
#include "device/launch.h"
#include "nn/ops/bilinear_sample.h"

namespace aligngs::cuda {

/// A thread per value of the output; the rows are mixed first, as on the CPU.
__global__ void resample_kernel(MapSpans m, AxisSpans vertical, AxisSpans horizontal) {
  const size_t i = item_index();
  if (i >= m.y.size) return;
  const auto channels = static_cast<size_t>(m.channels), width = horizontal.first.size - 1;
  const size_t c = i % channels, place = i / channels, column = place % width, row = place / width;
  float out = 0.0f;
  for (int h = horizontal.first[column]; h < horizontal.first[column + 1]; ++h) {
    float mixed = 0.0f;
    for (int v = vertical.first[row]; v < vertical.first[row + 1]; ++v) {
      const size_t from = size_t(vertical.index[size_t(v)]) * size_t(m.width) + size_t(horizontal.index[size_t(h)]);
      mixed += vertical.weight[size_t(v)] * m.x[from * channels + c];
    }
    out += horizontal.weight[size_t(h)] * mixed;
  }
  m.y[i] = out;
}

__global__ void pool_kernel(MapSpans m, nn::PatchShape shape) {
  const size_t i = item_index();
  if (i >= m.y.size) return;
  const int64_t c = int64_t(i) % m.channels, place = int64_t(i) / m.channels, width = shape.out_width();
  const int64_t top = place / width * shape.stride - shape.padding, left = place % width * shape.stride - shape.padding;
  float most = -INFINITY;
  for (int64_t v = top; v < top + shape.kernel; ++v) {
    for (int64_t u = left; u < left + shape.kernel; ++u) {
      if (v >= 0 && u >= 0 && v < m.height && u < m.width)
        most = std::max(most, m.x[size_t((v * m.width + u) * m.channels + c)]);
    }
  }
  m.y[i] = most;
}

__global__ void depthwise_kernel(MapSpans m, const float* weight, const float* bias) {
  const size_t i = item_index();
  if (i >= m.y.size) return;
  const int64_t c = int64_t(i) % m.channels, place = int64_t(i) / m.channels, row = place / m.width,
                column = place % m.width;
  float sum = bias[c];
  for (int64_t t = 0; t < 9; ++t) {
    const int64_t v = row + t / 3 - 1, u = column + t % 3 - 1;
    if (v < 0 || u < 0 || v >= m.height || u >= m.width) continue;
    sum += weight[t * m.channels + c] * m.x[size_t((v * m.width + u) * m.channels + c)];
  }
  m.y[i] = sum;
}

__global__ void spread_kernel(MapSpans m, int64_t kernel, const float* bias) {
  const size_t i = item_index();
  if (i >= m.y.size) return;
  const int64_t c = int64_t(i) % m.channels, place = int64_t(i) / m.channels, width = m.width * kernel;
  const int64_t row = place / width, column = place % width;
  const int64_t from = row / kernel * m.width + column / kernel, tap = row % kernel * kernel + column % kernel;
  m.y[i] = m.x[size_t((from * kernel * kernel + tap) * m.channels + c)] + (bias == nullptr ? 0.0f : bias[c]);
}

/// A thread per query, head and channel of the head: neighbouring threads read neighbouring floats of a place.
__global__ void deformable_kernel(DeformableSpans s) {
  const size_t i = item_index();
  if (i >= s.out.size) return;
  const auto dim = static_cast<size_t>(s.head_dim), heads = static_cast<size_t>(s.heads);
  const size_t d = i % dim, query_head = i / dim, head = query_head % heads, query = query_head / heads;
  const size_t samples = size_t(s.levels * s.points), width = heads * dim;
  const float* level_values = s.values.data + head * dim + d;
  float sum = 0.0f;
  for (int64_t l = 0; l < s.levels; ++l) {
    const int height = s.sizes[size_t(2 * l)], columns = s.sizes[size_t(2 * l + 1)];
    const size_t centre =
        (query * size_t(s.reference_levels) + size_t(l < s.reference_levels ? l : s.reference_levels - 1)) * 2;
    for (int64_t p = 0; p < s.points; ++p) {
      const size_t sample = query_head * samples + size_t(l * s.points + p);
      const float x = s.reference[centre] * float(columns) + s.offsets[sample * 2] - 0.5f;
      const float y = s.reference[centre + 1] * float(height) + s.offsets[sample * 2 + 1] - 0.5f;
      nn::add_bilinear_sample({level_values, int64_t(width), 1, height, columns}, x, y, s.attention[sample], &sum);
    }
    level_values += size_t(height) * size_t(columns) * width;
  }
  s.out[i] = sum;
}

void resample_map(const DeviceContext& context, const MapSpans& map, const AxisSpans& vertical,
                  const AxisSpans& horizontal) {
  launch(context, "resample", resample_kernel, one_per_item(map.y.size, kElementThreads), map, vertical, horizontal);
}
void pool_map(const DeviceContext& context, const MapSpans& map, const nn::PatchShape& shape) {
  launch(context, "max_pool", pool_kernel, one_per_item(map.y.size, kElementThreads), map, shape);
}
void depthwise_3x3(const DeviceContext& context, const MapSpans& map, const float* weight, const float* bias) {
  launch(context, "depthwise", depthwise_kernel, one_per_item(map.y.size, kElementThreads), map, weight, bias);
}
void spread_products(const DeviceContext& context, const MapSpans& products, int64_t kernel, const float* bias) {
  launch(context, "spread_products", spread_kernel, one_per_item(products.y.size, kElementThreads), products, kernel,
         bias);
}
void deformable_samples(const DeviceContext& context, const DeformableSpans& spans) {
  launch(context, "deformable", deformable_kernel, one_per_item(spans.out.size, kElementThreads), spans);
}

}  // namespace aligngs::cuda
