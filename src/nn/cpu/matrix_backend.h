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
  void multiply_operands(const void* x, int64_t rows, float* y, Scratch& scratch) const {
    scratch.count_operations(2.0 * double(rows) * double(inputs_) * double(outputs_));
    multiply_packed(x, rows, y, scratch);
  }

 protected:
  PackedMatrix(int64_t outputs, int64_t inputs, Precision precision)
      : outputs_(outputs), inputs_(inputs), precision_(precision) {}
  /// x: float, or bfloat16 bits with that precision.
  virtual void multiply_packed(const void* x, int64_t rows, float* y, Scratch& scratch) const = 0;

 private:
  int64_t outputs_, inputs_;
  Precision precision_;
};

class MatrixBackend {
 public:
  virtual ~MatrixBackend() = default;
  virtual std::string name() const = 0;
  /// Whether a row of a product is the same to the bit whatever rows are multiplied with it.
  virtual bool rows_are_independent() const { return false; }
  virtual std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const = 0;
};

/// oneDNN for bfloat16, if it is wanted and onednn_multiplies_bfloat16(); else the vector kernels.
std::shared_ptr<MatrixBackend> make_matrix_backend(const ComputeOptions& options);

/// Products of float32 vectors, whatever the weights are stored as.
std::shared_ptr<MatrixBackend> make_vector_backend(Precision precision);
/// Products of bfloat16; nullptr when oneDNN was not built in or does not support them on this processor.
std::shared_ptr<MatrixBackend> make_onednn_backend();
/// Whether oneDNN was built in and this processor has instructions for it, vectors or matrix tiles.
bool onednn_multiplies_bfloat16();

}  // namespace aligngs::nn
