// Starts kernels. For .cu files only.
#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "device/cuda_check.h"
#include "device/device_language.h"
#include "device/device_memory.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/emulated_devices.h"
#include "device/emulation/tape.h"
#endif

namespace aligngs::cuda {

struct LaunchShape {
  dim3 grid;
  dim3 block;               ///< a multiple of 32 threads
  size_t shared_bytes = 0;  ///< dynamic shared memory
};

/// One thread per item in blocks of `threads`.
inline LaunchShape one_per_item(size_t items, unsigned threads) {
  return {dim3(static_cast<unsigned>((items + threads - 1) / threads)), dim3(threads), 0};
}

/// Starts kernel(args...) on the context's device and stream; arguments are converted to the kernel's parameter types.
/// A grid without blocks starts nothing. Debug builds wait for the kernel, unless it is captured, so that its errors
/// carry its name.
template <class... P, class... A>
void launch(const DeviceContext& context, const char* name, void (*kernel)(P...), const LaunchShape& shape,
            A&&... args) {
  static_assert(sizeof...(P) == sizeof...(A));
  if (shape.grid.x == 0 || shape.grid.y == 0 || shape.grid.z == 0) return;
  if (shape.block.x * shape.block.y * shape.block.z % 32 != 0) {
    throw Error({ErrorKind::kFailed, std::string("kernel ") + name + ": blocks must be whole warps", {}, {}, {}});
  }
  context.use();
#ifdef ALIGNGS_CUDA_EMULATED
  require_current_device(context.stream(), name);
  emulated_stream_operation(name, [kernel, shape, values = std::tuple<P...>(static_cast<P>(args)...)] {
    auto body = [&] { std::apply(kernel, values); };
    emulate_grid(
        shape.grid, shape.block, shape.shared_bytes, [](void* b) { (*static_cast<decltype(body)*>(b))(); }, &body);
  });
#else
  constexpr size_t kWithoutAsking = 48 * 1024;  // dynamic shared memory that needs no attribute
  if (shape.shared_bytes > kWithoutAsking) {
    check_cuda(cudaFuncSetAttribute(reinterpret_cast<const void*>(kernel), cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(shape.shared_bytes)),
               name);
  }
  // clang-format off
  kernel<<<shape.grid, shape.block, shape.shared_bytes, context.stream()>>>(static_cast<P>(args)...);
  // clang-format on
  check_cuda(cudaGetLastError(), name);
#ifndef NDEBUG
  if (!context.capturing()) check_cuda(cudaStreamSynchronize(context.stream()), name);
#endif
#endif
}

}  // namespace aligngs::cuda
