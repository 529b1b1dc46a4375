// Peak rates of a CUDA device, measured now: every stage of a step on it is compared with them. The twin of
// engine/benchmark/machine_ceilings.h. Exists in builds without CUDA as well.
#pragma once

#include <cstdint>

namespace aligngs::cuda {

/// Best of several runs.
struct DeviceCeilings {
  double copy_gbps = 0;   ///< copying memory much larger than the caches, read and written bytes together, 1e9 bytes/s
  double fma_gflops = 0;  ///< float32 multiply-add from registers, 1e9 operations/s (two per multiply-add)
  /// bfloat16 products with float32 sums from registers by mma.m16n8k16, the instruction of this engine's kernels, 1e9
  /// operations/s. wgmma, which compute capability 9.0 has beside it, may reach more.
  double mma_gflops = 0;
};

/// How much is done per run.
struct CeilingEffort {
  /// per array, of which there are two; caches of devices hold up to 126 MB
  uint64_t copy_bytes = uint64_t(512) << 20;
  int rounds = 20000;                 ///< of the products: some milliseconds
  int blocks_per_multiprocessor = 8;  ///< of 256 threads: as many as a multiprocessor holds
  int runs = 5;
};
/// The effort of a measurement; minimal on an emulated device, whose rates mean nothing.
CeilingEffort usual_effort();

/// Takes a second and 1 GB of the device's memory. Throws Error{kResources} when the device or that memory is not
/// there.
DeviceCeilings measure_device_ceilings(int device, const CeilingEffort& effort = usual_effort());

}  // namespace aligngs::cuda
