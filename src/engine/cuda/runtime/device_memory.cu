#include "engine/cuda/runtime/device_memory.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string>

#include "core/error.h"
#include "core/memory_budget.h"
#include "engine/cuda/runtime/cuda_check.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "engine/cuda/runtime/emulation/tape.h"
#endif

namespace aligngs::cuda {
namespace {

constexpr uint64_t kAlignment = 256;  ///< what cudaMalloc gives: enough for every vector load and bulk copy

std::string megabytes(uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MB"; }

}  // namespace

void* DeviceContext::allocate(uint64_t bytes, const char* what) {
  void* memory = nullptr;
  uint64_t free_bytes = budget_ > used_ ? budget_ - used_ : 0;
  bool fits = bytes <= free_bytes;
  if (fits) {
#ifdef ALIGNGS_CUDA_EMULATED
    memory = ::operator new(bytes, std::align_val_t(kAlignment), std::nothrow);
    if (memory != nullptr) std::memset(memory, 0xFF, bytes);
#else
    const cudaError_t status = cudaMalloc(&memory, bytes);
    if (status == cudaErrorMemoryAllocation) {
      (void)cudaGetLastError();  // not sticky; the next launch must not report it
      size_t free_now = 0, total = 0;
      check_cuda(cudaMemGetInfo(&free_now, &total), "cudaMemGetInfo");
      free_bytes = free_now;
      memory = nullptr;
    } else {
      check_cuda(status, "cudaMalloc");
    }
#endif
    fits = memory != nullptr;
  }
  if (!fits) {
    throw Error({ErrorKind::kResources,
                 "the device has no room for " + std::string(what) + ": " + megabytes(bytes) + " wanted, " +
                     megabytes(used_) + " in use, " + megabytes(free_bytes) + " free",
                 {},
                 {},
                 "use fewer Gaussians, classes or views, smaller images, or --device cpu; the last checkpoint is valid"});
  }
  used_ += bytes;
  peak_ = std::max(peak_, used_);
  ++allocations_;
  return memory;
}

#ifdef ALIGNGS_CUDA_EMULATED

DeviceContext::DeviceContext(int device, uint64_t budget_bytes)
    : device_(device), budget_(budget_bytes != 0 ? budget_bytes : available_memory_bytes() / 10 * 9) {}
DeviceContext::~DeviceContext() = default;
void DeviceContext::release(void* memory, uint64_t bytes) noexcept {
  ::operator delete(memory, std::align_val_t(kAlignment));
  used_ -= bytes;
}
void DeviceContext::copy_to_device(void* device, const void* host, uint64_t bytes) const {
  refuse_while_recording("a copy of memory of the host");
  std::memcpy(device, host, bytes);
}
void DeviceContext::copy_to_host(void* host, const void* device, uint64_t bytes) const {
  refuse_while_recording("waiting for a copy");
  std::memcpy(host, device, bytes);
}
void DeviceContext::copy_to_host_later(void* host, const void* device, uint64_t bytes) const {
  emulated_stream_operation("copy to host", [=] { std::memcpy(host, device, bytes); });
}
void DeviceContext::copy_on_device(void* to, const void* from, uint64_t bytes) const {
  emulated_stream_operation("copy on device", [=] { std::memmove(to, from, bytes); });
}
void DeviceContext::fill_bytes(void* device, unsigned char value, uint64_t bytes) const {
  emulated_stream_operation("fill", [=] { std::memset(device, value, bytes); });
}
void DeviceContext::synchronise() const { refuse_while_recording("waiting for the device"); }

PinnedMemory::PinnedMemory(uint64_t bytes) : data_(::operator new(bytes)) {}
PinnedMemory::~PinnedMemory() { ::operator delete(data_); }

#else

void check_cuda(cudaError_t status, const char* operation) {
  if (status == cudaSuccess) return;
  const bool resources = status == cudaErrorMemoryAllocation || status == cudaErrorNoDevice ||
                         status == cudaErrorInsufficientDriver || status == cudaErrorInvalidDevice ||
                         status == cudaErrorDevicesUnavailable;
  throw Error({resources ? ErrorKind::kResources : ErrorKind::kFailed,
               std::string("CUDA, ") + operation + ": " + cudaGetErrorString(status),
               {},
               {},
               "use --device cpu; the last checkpoint is valid"});
}

DeviceContext::DeviceContext(int device, uint64_t budget_bytes) : device_(device), budget_(budget_bytes) {
  check_cuda(cudaSetDevice(device), "cudaSetDevice");
  if (budget_ == 0) {
    size_t free_now = 0, total = 0;
    check_cuda(cudaMemGetInfo(&free_now, &total), "cudaMemGetInfo");
    budget_ = free_now / 10 * 9;
  }
  check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate");
}
DeviceContext::~DeviceContext() {
  if (stream_ != nullptr) (void)cudaStreamDestroy(stream_);
}
void DeviceContext::release(void* memory, uint64_t bytes) noexcept {
  (void)cudaFree(memory);
  used_ -= bytes;
}
void DeviceContext::copy_to_device(void* device, const void* host, uint64_t bytes) const {
  check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream_), "copy to the device");
}
void DeviceContext::copy_to_host(void* host, const void* device, uint64_t bytes) const {
  copy_to_host_later(host, device, bytes);
  synchronise();
}
void DeviceContext::copy_to_host_later(void* host, const void* device, uint64_t bytes) const {
  check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream_), "copy to the host");
}
void DeviceContext::copy_on_device(void* to, const void* from, uint64_t bytes) const {
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream_), "copy on the device");
}
void DeviceContext::fill_bytes(void* device, unsigned char value, uint64_t bytes) const {
  check_cuda(cudaMemsetAsync(device, value, bytes, stream_), "fill");
}
void DeviceContext::synchronise() const { check_cuda(cudaStreamSynchronize(stream_), "waiting for the device"); }

PinnedMemory::PinnedMemory(uint64_t bytes) { check_cuda(cudaMallocHost(&data_, bytes), "cudaMallocHost"); }
PinnedMemory::~PinnedMemory() { (void)cudaFreeHost(data_); }

#endif

DeviceArena::~DeviceArena() { release(); }

void DeviceArena::release() {
  for (const Block& b : blocks_) context_->release(b.data, b.bytes);
  blocks_.clear();
  used_ = 0;
}

void DeviceArena::reset() {
#ifdef ALIGNGS_CUDA_EMULATED
  // A block per piece, fresh each time: stale reads give NaN, and a sanitizer sees reads beyond a piece.
  release();
#else
  if (blocks_.size() > 1) {
    uint64_t total = 0;
    for (const Block& b : blocks_) total += b.bytes;
    release();  // cudaFree waits for the work that uses it
    blocks_.push_back({static_cast<unsigned char*>(context_->allocate(total, "the scratch memory of a step")), total});
  }
#endif
  used_ = 0;
}

void* DeviceArena::take_bytes(uint64_t bytes, const char* what) {
  if (bytes == 0) return nullptr;
#ifdef ALIGNGS_CUDA_EMULATED
  blocks_.push_back({static_cast<unsigned char*>(context_->allocate(bytes, what)), bytes});
  return blocks_.back().data;
#else
  constexpr uint64_t kBlock = uint64_t(64) << 20;  // few allocations while cold, little waste on small scenes
  const uint64_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  if (blocks_.empty() || used_ + rounded > blocks_.back().bytes) {
    const uint64_t size = std::max(rounded, kBlock);
    blocks_.push_back({static_cast<unsigned char*>(context_->allocate(size, what)), size});
    used_ = 0;
  }
  void* piece = blocks_.back().data + used_;
  used_ += rounded;
  return piece;
#endif
}

}  // namespace aligngs::cuda
