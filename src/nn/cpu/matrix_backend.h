// Products with matrices of weights, packed once for the current processor.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "nn/compute.h"

namespace aligngs::nn {

/// W [outputs, inputs], kept in the layout and type of its backend. Safe to use from many threads.
class PackedMatrix {
 public:
  virtual ~PackedMatrix() = default;
  int64_t inputs() const { return inputs_; }
  int64_t outputs() const { return outputs_; }
  Precision precision() const { return precision_; }
  virtual size_t bytes() const = 0;

  /// y [rows, outputs] = x [rows, inputs] W^T on the calling thread.
  void multiply(const float* x, int64_t rows, float* y, Scratch& scratch) const;
  /// The same with x already of the operand type: float, or bfloat16 bits.
  virtual void multiply_operands(const void* x, int64_t rows, float* y, Scratch& scratch) const = 0;

 protected:
  PackedMatrix(int64_t outputs, int64_t inputs, Precision precision)
      : outputs_(outputs), inputs_(inputs), precision_(precision) {}

 private:
  int64_t outputs_, inputs_;
  Precision precision_;
};

class MatrixBackend {
 public:
  virtual ~MatrixBackend() = default;
  virtual std::string name() const = 0;
  virtual std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const = 0;
};

/// oneDNN when it was built in, is wanted and supports the precision here; else the portable one.
std::shared_ptr<MatrixBackend> make_matrix_backend(const ComputeOptions& options);

std::shared_ptr<MatrixBackend> make_portable_backend(Precision precision);
/// nullptr when oneDNN was not built in or does not support the precision on this processor.
std::shared_ptr<MatrixBackend> make_onednn_backend(Precision precision);

}  // namespace aligngs::nn
