#include "nn/values.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "nn/network_device.h"

namespace aligngs::nn {
namespace {

/// One for all: it is taken once per tensor and change of place, never per access.
std::mutex& transfer_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Values::Values(const std::vector<float>& values) : size_(values.size()), host_(values.size()), state_(kHost) {
  std::copy(values.begin(), values.end(), host_.data());
}

Values::Values(const Values& other) : size_(other.size_) {
  if (other.state_ == kDevice) {  // stays there
    device_ = other.device_;
    there_ = device_->allocate(size_);
    device_->copy(there_.get(), other.there_.get(), size_);
    state_ = kDevice;
  } else if (other.state_ != kNowhere) {
    host_ = HostFloats(size_);
    std::copy_n(other.host_.data(), size_, host_.data());
    state_ = kHost;
  }
}

Values::Values(Values&& other) noexcept { *this = std::move(other); }

Values& Values::operator=(const Values& other) {
  if (this != &other) *this = Values(other);
  return *this;
}

Values& Values::operator=(Values&& other) noexcept {
  if (this == &other) return *this;
  size_ = std::exchange(other.size_, 0);
  host_ = std::move(other.host_);
  there_ = std::move(other.there_);
  other.there_.reset();
  device_ = std::exchange(other.device_, nullptr);
  state_ = other.state_.exchange(kNowhere);
  return *this;
}

void Values::fetch() const {
  const std::lock_guard<std::mutex> lock(transfer_mutex());
  const uint8_t state = state_;
  if ((state & kHost) != 0) return;
  host_ = HostFloats(size_);
  if (state == kDevice && size_ > 0) device_->download(host_.data(), there_.get(), size_);
  state_.store(state | kHost, std::memory_order_release);
}

void Values::own_host() {
  fetch();
  const std::lock_guard<std::mutex> lock(transfer_mutex());
  if (state_ == kHost) return;
  there_.reset();
  state_.store(kHost, std::memory_order_release);
}

bool operator==(const Values& a, const Values& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

const float* Values::on(NetworkDevice& device) const {
  if (size_ == 0) return nullptr;
  if ((state_ & kDevice) != 0 && device_ == &device) return there_.get();
  fetch();
  const std::lock_guard<std::mutex> lock(transfer_mutex());
  there_ = device.allocate(size_);
  device_ = &device;
  device.upload(there_.get(), host_.data(), size_);
  state_.store(kHost | kDevice, std::memory_order_release);
  return there_.get();
}

float* Values::change_on(NetworkDevice& device) {
  if (size_ == 0) return nullptr;
  if (state_ == kNowhere) {
    there_ = device.allocate(size_);
    device_ = &device;
    device.clear(there_.get(), size_);
  } else {
    on(device);
  }
  state_ = kDevice;
  host_.release();
  return there_.get();
}

float* Values::write_on(NetworkDevice& device) {
  if (size_ == 0) return nullptr;
  if ((state_ & kDevice) == 0 || device_ != &device) there_ = device.allocate(size_);
  device_ = &device;
  state_ = kDevice;
  host_.release();
  return there_.get();
}

}  // namespace aligngs::nn
