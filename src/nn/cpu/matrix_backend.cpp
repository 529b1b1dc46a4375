#include "nn/cpu/matrix_backend.h"

#include "nn/cpu/row_kernels.h"

namespace aligngs::nn {

void PackedMatrix::multiply(const float* x, int64_t rows, float* y, Scratch& scratch) const {
  if (precision_ != Precision::kBfloat16) {
    multiply_operands(x, rows, y, scratch);
    return;
  }
  const Scratch::Frame frame(scratch);
  uint16_t* rounded = scratch.halves(static_cast<size_t>(rows * inputs_));
  round_to_bfloat16(x, rows * inputs_, false, rounded);
  multiply_operands(rounded, rows, y, scratch);
}

std::shared_ptr<MatrixBackend> make_matrix_backend(const ComputeOptions& options) {
  if (options.precision == Precision::kBfloat16 && options.onednn && onednn_multiplies_bfloat16())
    return make_onednn_backend();
  return make_vector_backend(options.precision);
}

bool onednn_multiplies_bfloat16() {
#if defined(__x86_64__) && !defined(ALIGNGS_SCALAR_ONLY)
  __builtin_cpu_init();
  static const bool multiplies = __builtin_cpu_supports("avx512bf16") && make_onednn_backend() != nullptr;
  return multiplies;
#else
  return false;
#endif
}

}  // namespace aligngs::nn
