#include "nn/cpu/matrix_backend.h"

#include "nn/cpu/row_kernels.h"

namespace aligngs::nn {

void PackedMatrix::multiply(const float* x, int64_t rows, float* y, Scratch& scratch) const {
  if (precision_ == Precision::kFloat32) {
    multiply_operands(x, rows, y, scratch);
    return;
  }
  const Scratch::Frame frame(scratch);
  uint16_t* rounded = scratch.halves(static_cast<size_t>(rows * inputs_));
  round_to_bfloat16(x, rows * inputs_, false, rounded);
  multiply_operands(rounded, rows, y, scratch);
}

std::shared_ptr<MatrixBackend> make_matrix_backend(const ComputeOptions& options) {
  if (options.onednn) {
    if (auto backend = make_onednn_backend(options.precision)) return backend;
  }
  return make_portable_backend(options.precision);
}

}  // namespace aligngs::nn
