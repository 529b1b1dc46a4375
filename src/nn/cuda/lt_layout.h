// How a product of this project is described to cuBLASLt, which is column-major. Plain C++: checked without the
// library.
#pragma once

#include <cstdint>

#include "nn/cuda/products.h"

namespace aligngs::cuda {

/// Element (row, column) lies at column * leading + row.
struct ColumnMajorMatrix {
  int64_t rows = 0, columns = 0, leading = 0;
  bool transposed = false;  ///< enters the product as its transpose
};

/// result = left right, each as the library sees it.
struct LtLayout {
  ColumnMajorMatrix left, right, result;
};

/// y [rows, outputs] = x [rows, depth] (w [outputs, depth])^T. y in row-major order is y^T in column-major order, and
/// y^T = w x^T. The weights come first, transposed, because in column-major order they read as w^T.
constexpr LtLayout lt_layout(int64_t rows, int64_t outputs, int64_t depth) {
  return {{depth, outputs, depth, true}, {depth, rows, depth, false}, {outputs, rows, outputs, false}};
}

/// The library's operation on the sums: its bias goes along the rows of y^T, which are the outputs.
struct LtEpilogue {
  bool bias = false, relu = false;
  bool activate_after = false;  ///< bias and activation by activate(), in a pass of their own
};

/// The library's GELU is the approximation by tanh and it has no SiLU, so both stay with activate(). Its bias and ReLU
/// are the formulas of the project.
constexpr LtEpilogue lt_epilogue(bool has_bias, nn::Activation activation) {
  switch (activation) {
    case nn::Activation::kNone:
      return {has_bias, false, false};
    case nn::Activation::kRelu:
      return {has_bias, true, false};
    default:
      return {false, false, true};
  }
}

/// Bytes that an address is a multiple of, as far as the library cares.
inline uint32_t alignment_of(const void* address) {
  constexpr uint32_t kMost = 256;  // what the library assumes unless told otherwise
  const auto bits = reinterpret_cast<uintptr_t>(address);
  uint32_t alignment = 1;
  while (alignment < kMost && bits % (2 * alignment) == 0) alignment *= 2;
  return alignment;
}

}  // namespace aligngs::cuda
