// Runs kernels as a lesser processor would, so that their speed can be measured on this one.
#pragma once

#include "core/choice_words.h"

namespace aligngs {

/// kAll: what the processor offers, matrix tiles included. The others: at most these vectors, and no matrix tiles.
enum class Instructions { kAll, kAvx512, kAvx2, kSse4 };

template <>
inline constexpr std::array<ChoiceWord<Instructions>, 4> kChoiceWords<Instructions> = {
    {{Instructions::kAll, "all"},
     {Instructions::kAvx512, "avx512"},
     {Instructions::kAvx2, "avx2"},
     {Instructions::kSse4, "sse4"}}};

/// While it lives, vector kernels of the whole process are chosen as if the processor had no wider vectors. Loops that
/// GCC compiles in several versions (core/target_clones.h) are chosen when the program starts and do not heed it: the
/// map losses. Not to be nested; create and destroy it while no kernel runs.
class InstructionLimit {
 public:
  explicit InstructionLimit(Instructions widest);
  ~InstructionLimit();
  InstructionLimit(const InstructionLimit&) = delete;
  InstructionLimit& operator=(const InstructionLimit&) = delete;
};

}  // namespace aligngs
