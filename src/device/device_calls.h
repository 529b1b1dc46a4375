// This program's calls of the CUDA runtime, one function each. Everything above is plain C++ and the same on a device
// and on its emulation (emulation/device_calls.cpp). As in CUDA, calls without a stream act on the current device of
// the calling thread. Work on a stream needs the stream's device to be current; DeviceContext ensures it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

struct CUstream_st;

namespace aligngs::cuda::calls {

/// 0 with the reason when there is none; never throws.
int device_count(std::string& reason);

// The following throw Error{kResources} when the device ran out of memory or is gone, Error{kFailed} otherwise.

int current_device();
/// Starts the device where nobody has used it yet, which takes a moment and memory.
void set_device(int device);

struct DeviceFacts {
  std::string name;
  int major = 0, minor = 0;            ///< compute capability
  size_t shared_memory_per_block = 0;  ///< bytes that a kernel may ask for
  int multiprocessors = 0;
  uint64_t memory_bytes = 0;  ///< that it has
};
DeviceFacts facts_of(int device);  ///< without starting it
/// Whether this build has kernels for a device of that compute capability.
bool has_code_for(int major, int minor);

struct DeviceMemory {
  uint64_t free_bytes = 0, total_bytes = 0;
};
DeviceMemory memory_of_current_device();

/// Aligned to 256 bytes, contents undefined (emulated: 0xFF, which is NaN); null when there is no room.
void* allocate(uint64_t bytes);
void release(void* memory) noexcept;  ///< waits for the work that uses it
/// For memory that is given out in pieces: nothing on a device. Emulated, in the stream's order: withheld memory is
/// filled with 0xFF again, and a sanitizer reports who touches it before it is handed out.
void withhold(void* memory, uint64_t bytes) noexcept;
void hand_out(void* memory, uint64_t bytes) noexcept;
void* allocate_pinned(uint64_t bytes);
void release_pinned(void* memory) noexcept;

CUstream_st* create_stream();
void destroy_stream(CUstream_st* stream) noexcept;
/// Waits: what the host gave may be gone on return. Other copies and fills are carried out in the stream's order.
void copy_to_device(void* device, const void* host, uint64_t bytes, CUstream_st* stream);
void copy_to_host(void* host, const void* device, uint64_t bytes, CUstream_st* stream);
void copy_on_device(void* to, const void* from, uint64_t bytes, CUstream_st* stream);
void fill_bytes(void* device, unsigned char value, uint64_t bytes, CUstream_st* stream);
void synchronise(CUstream_st* stream);

}  // namespace aligngs::cuda::calls
