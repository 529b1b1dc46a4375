// The devices that the emulation pretends to have: one, or as many as a test asks for. Memory belongs to the device
// that was current when it was allocated. As under CUDA, work on a stream of another device than the current one is an
// error. A forgotten change of the current device hence shows without two devices.
#pragma once

#include <cstdint>

struct CUstream_st {
  int device;
};

namespace aligngs::cuda {

/// Pretends to have `count` devices while it lives; one at a time. The calling thread is back on its device afterwards.
class ScopedEmulatedDevices {
 public:
  explicit ScopedEmulatedDevices(int count);
  ~ScopedEmulatedDevices();
  ScopedEmulatedDevices(const ScopedEmulatedDevices&) = delete;
  ScopedEmulatedDevices& operator=(const ScopedEmulatedDevices&) = delete;

 private:
  int previous_count_, previous_device_;
};

/// Bytes that are allocated on a device now, by whichever thread.
uint64_t emulated_bytes_on(int device);

/// Throws Error{kFailed} naming the operation when the stream belongs to another device than the current one.
void require_current_device(const CUstream_st* stream, const char* operation);

}  // namespace aligngs::cuda
