// On the processor.
#include "parity_case.h"

namespace aligngs::parity {

const std::vector<Mode>& modes() {
  static const std::vector<Mode> list = [] {
    const Mode exact{"float32", {}, 2e-5, 2e-5, 0};
    Mode portable = exact;
    portable.name = "float32 portable";
    portable.options.onednn = false;
    const Mode half{"bfloat16", {nn::Precision::kBfloat16, true, true}, 6e-2, 2e-2, 0.03};
    Mode half_portable = half;
    half_portable.name = "bfloat16 portable";
    half_portable.options.onednn = half_portable.options.amx = false;
    return std::vector<Mode>{exact, portable, half, half_portable};
  }();
  return list;
}

}  // namespace aligngs::parity
