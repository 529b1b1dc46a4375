// Runs vector kernels as a lesser processor would.
#pragma once

#include "nn/cpu/simd_targets.h"

#include <hwy/highway.h>
#include <vector>

namespace aligngs::nn {

/// While it lives, kernels use no better instructions than `target`, one of Highway's. Not to be nested.
class VectorLimit {
 public:
  explicit VectorLimit(int64_t target) { disable(target - 1); }  // a better target has a lower bit
  ~VectorLimit() { disable(0); }
  VectorLimit(const VectorLimit&) = delete;
  VectorLimit& operator=(const VectorLimit&) = delete;

 private:
  static void disable(int64_t targets) {
    hwy::DisableTargets(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

/// The targets for which kernels were compiled and that this processor has.
inline std::vector<int64_t> vector_targets() { return hwy::SupportedAndGeneratedTargets(); }

}  // namespace aligngs::nn
