// Floats of a tensor, on the host, on a device, or on both; copied when and only when they are needed elsewhere.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <vector>

#include "nn/host_floats.h"

namespace aligngs::nn {

class NetworkDevice;

/// Like std::vector<float> of a fixed size for host code, which gets the current values whatever made them. Access
/// through a const Values reads; any other access may write. Different threads may read at once, and write different
/// elements at once. Neither may happen while an operator of a device works on it. Pointers to the host's floats are
/// stale after such an operator has written.
class Values {
 public:
  using value_type = float;
  using size_type = size_t;
  using reference = float&;
  using const_reference = const float&;
  using iterator = float*;
  using const_iterator = const float*;

  Values() = default;
  explicit Values(size_t size) : size_(size) {}  ///< zeros, which need memory only once something looks at them
  Values(const std::vector<float>& values);
  Values(std::initializer_list<float> values) : Values(std::vector<float>(values)) {}
  Values(const Values& other);
  Values(Values&& other) noexcept;
  Values& operator=(const Values& other);
  Values& operator=(Values&& other) noexcept;

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const float* data() const {
    if ((state_.load(std::memory_order_acquire) & kHost) == 0) fetch();
    return host_.data();
  }
  float* data() {
    if (state_.load(std::memory_order_acquire) != kHost) own_host();
    return host_.data();
  }
  const float* begin() const { return data(); }
  const float* end() const { return data() + size_; }
  float* begin() { return data(); }
  float* end() { return data() + size_; }
  float operator[](size_t i) const { return data()[i]; }
  float& operator[](size_t i) { return data()[i]; }
  operator std::vector<float>() const { return {begin(), end()}; }
  friend bool operator==(const Values& a, const Values& b);

  /// The device that alone has the current floats, or null.
  NetworkDevice* where() const { return state_.load(std::memory_order_acquire) == kDevice ? device_ : nullptr; }
  /// The same floats on the device, to be read there; null when there are none.
  const float* on(NetworkDevice& device) const;
  /// To be read and written there: the host's floats are out of date.
  float* change_on(NetworkDevice& device);
  /// To be written there entirely: what was before is lost.
  float* write_on(NetworkDevice& device);

 private:
  enum : uint8_t { kNowhere = 0, kHost = 1, kDevice = 2 };  // kNowhere: zeros

  void fetch() const;
  void own_host();

  size_t size_ = 0;
  mutable HostFloats host_;
  mutable std::shared_ptr<float> there_;
  mutable NetworkDevice* device_ = nullptr;  ///< of `there_`
  mutable std::atomic<uint8_t> state_{kNowhere};
};

}  // namespace aligngs::nn
