// Copies and sums of parts of tensors, done where the tensors are: on the host or on a device.
#pragma once

#include "nn/compute.h"
#include "nn/values.h"

namespace aligngs::nn {

/// Rows of a tensor: the first begins at float `first`, the others `stride` floats after each other.
struct Block {
  int64_t first = 0, stride = 0;
};

/// `rows` x `columns` floats: to = from, or to += from.
void copy_block(Values& to, const Block& to_block, const Values& from, const Block& from_block, int64_t rows,
                int64_t columns);
/// The same on all threads, for many floats.
void copy_block(Compute& compute, Values& to, const Block& to_block, const Values& from, const Block& from_block,
                int64_t rows, int64_t columns);
void add_block(Values& to, const Block& to_block, const Values& from, const Block& from_block, int64_t rows,
               int64_t columns);
/// x += y, or x += max(y, 0); both of one size.
void add_values(Values& x, const Values& y, bool rectified = false);

}  // namespace aligngs::nn
