#include "nn/cuda/device_pool.h"

#include <algorithm>

#include "core/error.h"

namespace aligngs::cuda {
namespace {

/// Sizes with three significant bits: at most a quarter too much, and few different ones.
uint64_t rounded_up(uint64_t bytes) {
  constexpr uint64_t kLeast = 512;
  uint64_t step = kLeast / 4;
  while (step * 8 < bytes) step *= 2;
  return std::max((bytes + step - 1) / step * step, kLeast);
}

}  // namespace

DevicePool::~DevicePool() { release_unused(); }

std::shared_ptr<void> DevicePool::take(uint64_t bytes, const char* what) {
  const uint64_t size = rounded_up(bytes);
  const std::lock_guard<std::mutex> lock(mutex_);
  void* memory = nullptr;
  std::vector<void*>& fitting = unused_[size];
  if (!fitting.empty()) {
    memory = fitting.back();
    fitting.pop_back();
  } else {
    try {
      memory = context_.allocate(size, what);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kResources) throw;
      context_.synchronise();  // work may still use what is given back to the device now
      release_unused();
      try {
        memory = context_.allocate(size, what);
      } catch (const Error& again) {
        Error::Details details = again.details();
        details.remedy = "use fewer or smaller images, or --device cpu";
        throw Error(details);
      }
    }
  }
#ifdef ALIGNGS_CUDA_EMULATED
  context_.fill_bytes(memory, 0xFF, size);  // NaN, so that reads of what was never written show in tests
#endif
  return {memory, [pool = shared_from_this(), size](void* m) { pool->give_back(m, size); }};
}

void DevicePool::give_back(void* memory, uint64_t bytes) noexcept {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    unused_[bytes].push_back(memory);
  } catch (...) {  // no room for the note: back to the device at once
    context_.release(memory, bytes);
  }
}

void DevicePool::release_unused() {
  for (auto& [bytes, pieces] : unused_) {
    for (void* piece : pieces) context_.release(piece, bytes);
    pieces.clear();
  }
}

}  // namespace aligngs::cuda
