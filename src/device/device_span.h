// Memory of the device as kernels and parameter structs see it.
#pragma once

#include <cstddef>
#include <type_traits>

#include "core/host_device.h"

#ifdef ALIGNGS_CUDA_EMULATED
#include <string>

#include "core/error.h"
#endif

namespace aligngs::cuda {

/// `size` elements at `data`, which the host must not read. Emulated: an index out of range is an Error.
template <class T>
struct DeviceSpan {
  T* data = nullptr;
  size_t size = 0;

  ALIGNGS_HD T& operator[](size_t i) const {
#ifdef ALIGNGS_CUDA_EMULATED
    if (i >= size) {
      throw Error({ErrorKind::kFailed,
                   "index " + std::to_string(i) + " of device memory with " + std::to_string(size) + " elements",
                   {},
                   {},
                   {}});
    }
#endif
    return data[i];
  }
  /// Elements [first, first + count).
  ALIGNGS_HD DeviceSpan part(size_t first, size_t count) const { return {data + first, count}; }
  ALIGNGS_HD bool empty() const { return size == 0; }
  template <class U = T, class = std::enable_if_t<!std::is_const_v<U>>>
  ALIGNGS_HD operator DeviceSpan<const U>() const {
    return {data, size};
  }
};

}  // namespace aligngs::cuda
