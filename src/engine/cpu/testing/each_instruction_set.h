// For tests: vector kernels under each instruction set that they were compiled for and this processor has.
#pragma once

#include "engine/cpu/simd_targets.h"  // which targets there are: before Highway

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace aligngs::cpu {

template <class Body>
void for_each_target(const Body& body) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace aligngs::cpu
