// Memory of a device for tensors that come and go: given back pieces serve later ones of about the same size.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "device/device_memory.h"

namespace aligngs::cuda {

/// Work on the pool's stream goes in order, so a piece may be given back while work on it is still to be done.
class DevicePool : public std::enable_shared_from_this<DevicePool> {
 public:
  DevicePool(int device, uint64_t budget_bytes) : context_(device, budget_bytes) {}
  ~DevicePool();

  /// Goes back to the pool when the last owner is gone; the pool lives until then. Error{kResources} when there is no
  /// room even without the pieces that nobody uses.
  std::shared_ptr<void> take(uint64_t bytes, const char* what);
  template <class T>
  std::shared_ptr<T> take(size_t count, const char* what) {
    return std::static_pointer_cast<T>(take(uint64_t(count) * sizeof(T), what));
  }
  DeviceContext& context() { return context_; }

 private:
  void give_back(void* memory, uint64_t bytes) noexcept;
  void release_unused();

  DeviceContext context_;
  std::mutex mutex_;
  std::map<uint64_t, std::vector<void*>> unused_;  ///< by bytes
};

}  // namespace aligngs::cuda
