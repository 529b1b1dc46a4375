// Peak rates of this machine, measured now: every stage is compared with them.
#pragma once

#include <string>

#include "core/thread_pool.h"

namespace aligngs {

/// Rates of all threads of a pool together; best of several short runs, because other programs may run as well.
struct MachineCeilings {
  std::string instructions;  ///< widest vector instructions in use, e.g. "AVX3_SPR"
  double fma_gflops = 0;     ///< float32 multiply-add from registers, 1e9 operations/s (two per multiply-add)
  double amx_gflops = 0;     ///< bfloat16 tile products from registers, 1e9 operations/s; 0: this processor has none
  double read_gbps = 0;      ///< reading memory much larger than the caches, 1e9 bytes/s
  double triad_gbps = 0;     ///< a[i] = b[i] + s c[i] there: 12 bytes per element, 1e9 bytes/s
};

/// Takes about a second and, for its duration, 400 MB. Without `matrix_tiles` those of a processor that has none.
MachineCeilings measure_ceilings(ThreadPool& pool, bool matrix_tiles = true);

/// Two of these figures alone, in some tens of milliseconds each.
double measure_fma_gflops(ThreadPool& pool);
double measure_amx_gflops(ThreadPool& pool);

/// Seconds that `flops` operations of the best kind and `bytes` of memory traffic need at least, were they done one
/// beside the other without loss.
double floor_seconds(const MachineCeilings& ceilings, double vector_flops, double matrix_flops, double bytes);

}  // namespace aligngs
