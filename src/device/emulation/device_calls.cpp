#include "device/device_calls.h"

#include <atomic>
#include <cstring>
#include <map>
#include <mutex>
#include <new>

#include "core/error.h"
#include "core/memory_budget.h"
#include "device/cuda_device.h"
#include "device/emulation/emulated_devices.h"
#include "device/emulation/tape.h"

// In builds without the address sanitizer its marks are nothing.
#if __has_include(<sanitizer/asan_interface.h>)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(memory, bytes) ((void)(memory), (void)(bytes))
#define ASAN_UNPOISON_MEMORY_REGION(memory, bytes) ((void)(memory), (void)(bytes))
#endif

namespace aligngs::cuda {
namespace {

constexpr std::align_val_t kEmulatedAlignment{256};  // as cudaMalloc gives it

std::atomic<int> device_total{1};
thread_local int current = 0;

struct EmulatedMemory {
  int device;
  uint64_t bytes;
};
std::mutex memory_mutex;
std::map<void*, EmulatedMemory>& memory_map() {
  static auto* map = new std::map<void*, EmulatedMemory>();  // outlives every owner of memory
  return *map;
}

}  // namespace

ScopedEmulatedDevices::ScopedEmulatedDevices(int count)
    : previous_count_(device_total.exchange(count)), previous_device_(current) {}
ScopedEmulatedDevices::~ScopedEmulatedDevices() {
  device_total = previous_count_;
  current = previous_device_;
}

uint64_t emulated_bytes_on(int device) {
  const std::lock_guard<std::mutex> lock(memory_mutex);
  uint64_t sum = 0;
  for (const auto& [address, memory] : memory_map()) {
    if (memory.device == device) sum += memory.bytes;
  }
  return sum;
}

void require_current_device(const CUstream_st* stream, const char* operation) {
  if (stream->device == current) return;
  throw Error({ErrorKind::kFailed,
               std::string(operation) + " on a stream of cuda:" + std::to_string(stream->device) +
                   " while cuda:" + std::to_string(current) + " is current",
               {},
               {},
               {}});
}

std::string cuda_build() { return "emulated on the CPU"; }

namespace calls {

int device_count(std::string&) { return device_total; }
int current_device() { return current; }
void set_device(int device) {
  if (device < 0 || device >= device_total) {
    throw Error({ErrorKind::kResources, "the emulation has no cuda:" + std::to_string(device), {}, {}, {}});
  }
  current = device;
}

DeviceFacts facts_of(int) { return {"emulated CUDA device", 9, 0, size_t(227) * 1024, 1, available_memory_bytes()}; }
bool has_code_for(int, int) { return true; }
DeviceMemory memory_of_current_device() {
  const uint64_t bytes = available_memory_bytes();
  return {bytes, bytes};
}

void* allocate(uint64_t bytes) {
  void* memory = ::operator new(bytes, kEmulatedAlignment, std::nothrow);
  if (memory == nullptr) return nullptr;
  std::memset(memory, 0xFF, bytes);  // NaN: reads of what was never written show
  const std::lock_guard<std::mutex> lock(memory_mutex);
  memory_map()[memory] = {current, bytes};
  return memory;
}
void release(void* memory) noexcept {
  {
    const std::lock_guard<std::mutex> lock(memory_mutex);
    const auto found = memory_map().find(memory);
    ASAN_UNPOISON_MEMORY_REGION(memory, found->second.bytes);
    memory_map().erase(found);
  }
  ::operator delete(memory, kEmulatedAlignment);
}
// In the order of the stream: an arena may be emptied in the middle of what a graph records and carries out later.
void withhold(void* memory, uint64_t bytes) noexcept {
  emulated_stream_operation("withhold", [=] {
    ASAN_UNPOISON_MEMORY_REGION(memory, bytes);
    std::memset(memory, 0xFF, bytes);
    ASAN_POISON_MEMORY_REGION(memory, bytes);
  });
}
void hand_out(void* memory, uint64_t bytes) noexcept {
  emulated_stream_operation("hand out", [=] { ASAN_UNPOISON_MEMORY_REGION(memory, bytes); });
}
void* allocate_pinned(uint64_t bytes) { return ::operator new(bytes); }
void release_pinned(void* memory) noexcept { ::operator delete(memory); }

CUstream_st* create_stream() { return new CUstream_st{current}; }
void destroy_stream(CUstream_st* stream) noexcept { delete stream; }

void copy_to_device(void* device, const void* host, uint64_t bytes, CUstream_st* stream) {
  require_current_device(stream, "copy to the device");
  refuse_while_recording("a copy of memory of the host");
  std::memcpy(device, host, bytes);
}
void copy_to_host(void* host, const void* device, uint64_t bytes, CUstream_st* stream) {
  require_current_device(stream, "copy to the host");
  emulated_stream_operation("copy to host", [=] { std::memcpy(host, device, bytes); });
}
void copy_on_device(void* to, const void* from, uint64_t bytes, CUstream_st* stream) {
  require_current_device(stream, "copy on the device");
  emulated_stream_operation("copy on device", [=] { std::memmove(to, from, bytes); });
}
void fill_bytes(void* device, unsigned char value, uint64_t bytes, CUstream_st* stream) {
  require_current_device(stream, "fill");
  emulated_stream_operation("fill", [=] { std::memset(device, value, bytes); });
}
void synchronise(CUstream_st* stream) {
  require_current_device(stream, "waiting");
  refuse_while_recording("waiting for the device");
}

}  // namespace calls
}  // namespace aligngs::cuda
