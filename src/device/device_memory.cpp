#include "device/device_memory.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "device/device_calls.h"

namespace aligngs::cuda {
namespace {

constexpr uint64_t kAlignment = 256;  ///< what cudaMalloc gives: enough for every vector load and bulk copy
constexpr uint64_t kFirstBlock = uint64_t(1) << 20;  ///< of an arena; on a device an allocation takes no less
constexpr uint64_t kSpareShare = 8;  ///< an eighth of a warm arena is spare, as lists change their length between
                                     ///< visits. A block takes at most an eighth of the room left beyond its piece

std::string megabytes(uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MB"; }

}  // namespace

DeviceContext::DeviceContext(int device, uint64_t budget_bytes, std::string remedy)
    : device_(device), remedy_(std::move(remedy)), budget_(budget_bytes) {
  calls::set_device(device);
  facts_ = calls::facts_of(device);
  if (budget_ == 0) budget_ = calls::memory_of_current_device().free_bytes / 10 * 9;
  stream_ = calls::create_stream();
}

DeviceContext::~DeviceContext() { calls::destroy_stream(stream_); }

void DeviceContext::use() const {
  if (calls::current_device() != device_) calls::set_device(device_);
}

void DeviceContext::may_allocate(const char* what) const {
  if (!capturing_) return;
  growth_refused_ = true;
  throw Error(
      {ErrorKind::kFailed, std::string("memory for ") + what + " has to grow, which a capture cannot", {}, {}, {}});
}

void* DeviceContext::allocate(uint64_t bytes, const char* what) {
  may_allocate(what);
  use();
  void* memory = nullptr;
  uint64_t free_bytes = room();
  if (bytes <= free_bytes) {
    memory = calls::allocate(bytes);
    if (memory == nullptr) free_bytes = calls::memory_of_current_device().free_bytes;
  }
  if (memory == nullptr) {
    throw Error({ErrorKind::kResources,
                 "the device has no room for " + std::string(what) + ": " + megabytes(bytes) + " wanted, " +
                     megabytes(used_) + " in use, " + megabytes(free_bytes) + " free",
                 {},
                 {},
                 remedy_});
  }
  used_ += bytes;
  peak_ = std::max(peak_, used_);
  ++allocations_;
  return memory;
}

void DeviceContext::release(void* memory, uint64_t bytes) noexcept {
  try {
    use();
  } catch (const Error&) {  // the device is gone, and its memory with it
  }
  calls::release(memory);
  used_ -= bytes;
}

void DeviceContext::copy_to_device(void* device, const void* host, uint64_t bytes) const {
  use();
  calls::copy_to_device(device, host, bytes, stream_);
}
void DeviceContext::copy_to_host(void* host, const void* device, uint64_t bytes) const {
  copy_to_host_later(host, device, bytes);
  synchronise();
}
void DeviceContext::copy_to_host_later(void* host, const void* device, uint64_t bytes) const {
  use();
  calls::copy_to_host(host, device, bytes, stream_);
}
void DeviceContext::copy_on_device(void* to, const void* from, uint64_t bytes) const {
  use();
  calls::copy_on_device(to, from, bytes, stream_);
}
void DeviceContext::fill_bytes(void* device, unsigned char value, uint64_t bytes) const {
  use();
  calls::fill_bytes(device, value, bytes, stream_);
}
void DeviceContext::synchronise() const {
  use();
  ++synchronisations_;
  calls::synchronise(stream_);
}

PinnedMemory::PinnedMemory(const DeviceContext& context, uint64_t bytes) {
  context.use();
  data_ = calls::allocate_pinned(bytes);
}
PinnedMemory::~PinnedMemory() { calls::release_pinned(data_); }

DeviceArena::~DeviceArena() { release(); }

void DeviceArena::release() {
  for (const Block& b : blocks_) context_->release(b.data, b.bytes);
  blocks_.clear();
  used_ = taken_ = held_ = 0;
}

void DeviceArena::add_block(uint64_t bytes, const char* what) {
  blocks_.push_back({static_cast<unsigned char*>(context_->allocate(bytes, what)), bytes});
  calls::withhold(blocks_.back().data, bytes);
  held_ += bytes;
  used_ = 0;
}

void DeviceArena::reset() {
  if (blocks_.size() > 1) {
    const uint64_t taken = taken_;
    release();  // waits for the work that uses it
    add_block(std::max(taken, std::min(taken + taken / kSpareShare, context_->room())), "the scratch memory of a step");
  } else if (!blocks_.empty()) {
    calls::withhold(blocks_.back().data, used_);
  }
  used_ = taken_ = 0;
}

void* DeviceArena::take_bytes(uint64_t bytes, const char* what) {
  if (bytes == 0) return nullptr;
  const uint64_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  if (blocks_.empty() || used_ + rounded > blocks_.back().bytes) {
    // As much again as there is, so that a cold step allocates a few times only. Near the end of the budget it is
    // little beyond the piece, because the rest of a block is unused.
    add_block(std::max(rounded, std::min(std::max(held_, kFirstBlock), context_->room() / kSpareShare)), what);
  }
  unsigned char* piece = blocks_.back().data + used_;
  calls::hand_out(piece, bytes);
  used_ += rounded;
  taken_ += rounded;
  return piece;
}

}  // namespace aligngs::cuda
