// On the processor.
#include "parity_case.h"

namespace aligngs::parity {

const std::vector<Mode>& modes() {
  static const std::vector<Mode> list = [] {
    const Mode exact{"float32", {}, 2e-5, 2e-5, 0};
    const Mode weights{"float16 weights", {nn::Precision::kFloat16}, 2e-3, 1e-3, 0.005};
    const Mode half{"bfloat16", {nn::Precision::kBfloat16, true, true}, 6e-2, 2e-2, 0.03};
    Mode in_vectors = half;
    in_vectors.name = "bfloat16 in vectors";
    in_vectors.options.onednn = in_vectors.options.amx = false;
    return std::vector<Mode>{exact, weights, half, in_vectors};
  }();
  return list;
}

}  // namespace aligngs::parity
