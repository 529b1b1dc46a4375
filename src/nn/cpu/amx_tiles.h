// The matrix tiles of x86 processors (AMX, bfloat16): whether they may be used, and their shape.
#pragma once

#if defined(__x86_64__) && !defined(ALIGNGS_SCALAR_ONLY)
#define ALIGNGS_WITH_AMX
/// Marks a function for instructions that the rest of the program does not assume.
#define ALIGNGS_AMX_TARGET __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx512bf16,amx-tile,amx-bf16")))
#endif

namespace aligngs::nn {

/// Whether processor and operating system offer AMX-BF16 and AVX-512 BF16 to this process.
bool amx_usable();

/// Gives all eight tiles of this thread 16 rows of 64 bytes, until it ends. Only where amx_usable().
class TilesInUse {
 public:
  TilesInUse();
  ~TilesInUse();
  TilesInUse(const TilesInUse&) = delete;
  TilesInUse& operator=(const TilesInUse&) = delete;
};

}  // namespace aligngs::nn
