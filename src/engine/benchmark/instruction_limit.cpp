#include "engine/benchmark/instruction_limit.h"

#include "engine/cpu/simd_targets.h"

#include <hwy/highway.h>

namespace aligngs {
namespace {

/// Highway gives a better target a lower bit: everything below the widest that is allowed.
int64_t better_than(Instructions widest) {
  switch (widest) {
    case Instructions::kAvx512:
      return int64_t(HWY_AVX3) - 1;
    case Instructions::kAvx2:
      return int64_t(HWY_AVX2) - 1;
    case Instructions::kSse4:
      return int64_t(HWY_SSE4) - 1;
    case Instructions::kAll:
      break;
  }
  return 0;
}

void disable(int64_t targets) {
  hwy::DisableTargets(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

InstructionLimit::InstructionLimit(Instructions widest) { disable(better_than(widest)); }
InstructionLimit::~InstructionLimit() { disable(0); }

}  // namespace aligngs
