#include "nn/ops/blocks.h"

#include <algorithm>

#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

void move_block(Values& to, const Block& to_block, const Values& from, const Block& from_block, int64_t rows,
                int64_t columns, bool add) {
  if (rows <= 0 || columns <= 0) return;
  NetworkDevice* const device = from.where() != nullptr ? from.where() : to.where();
  if (device != nullptr) {
    device->copy_columns(to.change_on(*device) + to_block.first, to_block.stride, from.on(*device) + from_block.first,
                         from_block.stride, rows, columns, add);
    return;
  }
  float* target = to.data() + to_block.first;
  const float* source = from.data() + from_block.first;
  for (int64_t r = 0; r < rows; ++r, target += to_block.stride, source += from_block.stride) {
    if (!add) std::copy_n(source, columns, target);
    for (int64_t c = 0; add && c < columns; ++c) target[c] += source[c];
  }
}

}  // namespace

void copy_block(Values& to, const Block& to_block, const Values& from, const Block& from_block, int64_t rows,
                int64_t columns) {
  move_block(to, to_block, from, from_block, rows, columns, false);
}

void copy_block(Compute& compute, Values& to, const Block& to_block, const Values& from, const Block& from_block,
                int64_t rows, int64_t columns) {
  if (from.where() || to.where() || rows <= 0) return copy_block(to, to_block, from, from_block, rows, columns);
  float* const target = to.data() + to_block.first;
  const float* const source = from.data() + from_block.first;
  constexpr int64_t kFloats = 1 << 16;  // of a share: 256 KB
  if (rows == 1) {
    compute.for_rows(columns, kFloats, [&](int64_t begin, int64_t count, Scratch&) {
      std::copy_n(source + begin, count, target + begin);
    });
    return;
  }
  compute.for_rows(rows, std::max<int64_t>(1, kFloats / std::max<int64_t>(1, columns)),
                   [&](int64_t begin, int64_t count, Scratch&) {
                     for (int64_t r = begin; r < begin + count; ++r)
                       std::copy_n(source + r * from_block.stride, columns, target + r * to_block.stride);
                   });
}

void add_block(Values& to, const Block& to_block, const Values& from, const Block& from_block, int64_t rows,
               int64_t columns) {
  move_block(to, to_block, from, from_block, rows, columns, true);
}

void add_values(Values& x, const Values& y, bool rectified) {
  if (NetworkDevice* const device = x.where() != nullptr ? x.where() : y.where()) {
    float* const to = x.change_on(*device);
    device->add(to, y.on(*device), x.size(), rectified);
    return;
  }
  float* const to = x.data();
  const float* const from = y.data();
  for (size_t i = 0; i < x.size(); ++i) to[i] += rectified ? std::max(from[i], 0.0f) : from[i];
}

}  // namespace aligngs::nn
