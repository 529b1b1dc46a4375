#include "engine/benchmark/instruction_limit.h"

#include <gtest/gtest.h>

#include <string>

#include "core/thread_pool.h"
#include "engine/benchmark/machine_ceilings.h"

namespace aligngs {
namespace {

std::string instructions_in_use() {
  ThreadPool pool(1);
  return measure_ceilings(pool).instructions;
}

TEST(InstructionLimit, KernelsUseNoWiderVectorsWhileItLives) {
  const std::string before = instructions_in_use();
  {
    const InstructionLimit limit(Instructions::kSse4);
    const std::string limited = instructions_in_use();
    EXPECT_TRUE(limited == "SSE4" || limited == "SSE2" || limited == "SCALAR" || limited == "EMU128" ||
                limited == before)
        << limited;
    EXPECT_NE(limited.substr(0, 3), "AVX");
  }
  EXPECT_EQ(instructions_in_use(), before);
}

TEST(InstructionLimit, NoLimitChangesNothing) {
  const std::string before = instructions_in_use();
  const InstructionLimit limit(Instructions::kAll);
  EXPECT_EQ(instructions_in_use(), before);
}

TEST(InstructionLimit, CeilingsOfAProcessorWithoutMatrixTiles) {
  ThreadPool pool(1);
  EXPECT_EQ(measure_ceilings(pool, false).amx_gflops, 0);
}

}  // namespace
}  // namespace aligngs
