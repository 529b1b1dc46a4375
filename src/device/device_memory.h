// Memory of the device: a context with a budget, owning arrays, and the arena of a step. Plain C++ over device_calls.h.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "device/device_calls.h"
#include "device/device_span.h"

struct CUstream_st;

namespace aligngs::cuda {

/// One device, one stream, one budget. Everything of an engine happens in order on the stream. Whatever allocates,
/// copies or launches through a context works on its device, from any thread.
class DeviceContext {
 public:
  static constexpr const char* kRemedyOfTraining =
      "use fewer Gaussians, classes or views, smaller images, or --device cpu; the last checkpoint is valid";

  /// budget_bytes == 0: nine tenths of what is free on the device now. `remedy` is for errors of memory that is not
  /// there.
  explicit DeviceContext(int device, uint64_t budget_bytes = 0, std::string remedy = kRemedyOfTraining);
  ~DeviceContext();
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;

  /// Makes the context's device the current one of the calling thread, as all functions below and launch() do; to be
  /// called before another library's functions. The previous current device is not restored. Nothing else relies on it,
  /// and restoring it would start a device that the run does not use.
  void use() const;
  const calls::DeviceFacts& facts() const { return facts_; }

  /// While operations are captured (step_graph.h) no memory can be taken or given back: may_allocate() throws then, and
  /// growth_refused() says whether somebody asked.
  void begin_capture() const { capturing_ = true, growth_refused_ = false; }
  void end_capture() const { capturing_ = false; }
  bool growth_refused() const { return growth_refused_; }
  bool capturing() const { return capturing_; }
  void may_allocate(const char* what) const;

  /// Throws Error{kResources} naming what, the bytes wanted, used and allowed, and a remedy. Aligned to 256 bytes.
  void* allocate(uint64_t bytes, const char* what);
  void release(void* memory, uint64_t bytes) noexcept;

  void copy_to_device(void* device, const void* host, uint64_t bytes) const;
  void copy_to_host(void* host, const void* device, uint64_t bytes) const;  ///< waits for it
  /// Returns at once; the host memory is valid after synchronise(). `host` should be pinned.
  void copy_to_host_later(void* host, const void* device, uint64_t bytes) const;
  void copy_on_device(void* to, const void* from, uint64_t bytes) const;
  void fill_bytes(void* device, unsigned char value, uint64_t bytes) const;
  void synchronise() const;

  CUstream_st* stream() const { return stream_; }
  int device() const { return device_; }
  uint64_t budget() const { return budget_; }
  uint64_t used() const { return used_; }
  uint64_t room() const { return budget_ > used_ ? budget_ - used_ : 0; }  ///< left of the budget
  uint64_t peak() const { return peak_; }
  // Since the start, to show that a warm step makes no allocation and waits once.
  uint64_t allocations() const { return allocations_; }
  uint64_t synchronisations() const { return synchronisations_; }

 private:
  int device_ = 0;
  std::string remedy_;
  calls::DeviceFacts facts_;  ///< asked for once: that takes a moment
  uint64_t budget_ = 0, used_ = 0, peak_ = 0, allocations_ = 0;
  mutable uint64_t synchronisations_ = 0;
  mutable bool capturing_ = false, growth_refused_ = false;
  CUstream_st* stream_ = nullptr;
};

template <class T>
void fill_zero(const DeviceContext& context, DeviceSpan<T> span) {
  if (span.size > 0) context.fill_bytes(span.data, 0, span.size * sizeof(T));
}
template <class T>
void upload(const DeviceContext& context, DeviceSpan<T> to, const T* from) {
  if (to.size > 0) context.copy_to_device(to.data, from, to.size * sizeof(T));
}
template <class T>
void copy(const DeviceContext& context, DeviceSpan<T> to, DeviceSpan<const std::type_identity_t<T>> from) {
  if (from.size > 0) context.copy_on_device(to.data, from.data, from.size * sizeof(T));
}
template <class T>
void download(const DeviceContext& context, T* to, DeviceSpan<const std::type_identity_t<T>> from) {
  if (from.size > 0) context.copy_to_host(to, from.data, from.size * sizeof(T));
}

/// Owns elements on the device. Contents are undefined after resize().
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(DeviceContext& context, size_t size, const char* what) { resize(context, size, what); }
  ~DeviceArray() { clear(); }
  DeviceArray(DeviceArray&& o) noexcept { swap(o); }
  DeviceArray& operator=(DeviceArray&& o) noexcept {
    if (this != &o) {
      clear();
      swap(o);
    }
    return *this;
  }

  /// Keeps the memory when it is enough and at most twice too much.
  void resize(DeviceContext& context, size_t size, const char* what) {
    if (size > capacity_ || size < capacity_ / 2) {
      context.may_allocate(what);
      clear();
      data_ = size == 0 ? nullptr : static_cast<T*>(context.allocate(size * sizeof(T), what));
      context_ = &context;
      capacity_ = size;
    }
    size_ = size;
  }
  void assign(DeviceContext& context, const std::vector<T>& values, const char* what) {
    resize(context, values.size(), what);
    upload(context, span(), values.data());
  }
  void clear() noexcept {
    if (data_ != nullptr) context_->release(data_, capacity_ * sizeof(T));
    data_ = nullptr;
    size_ = capacity_ = 0;
  }
  void swap(DeviceArray& o) noexcept {
    std::swap(context_, o.context_);
    std::swap(data_, o.data_);
    std::swap(size_, o.size_);
    std::swap(capacity_, o.capacity_);
  }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  DeviceSpan<T> span() { return {data_, size_}; }
  DeviceSpan<const T> span() const { return {data_, size_}; }
  std::vector<T> to_host() const {
    std::vector<T> out(size_);
    if (size_ > 0) download(*context_, out.data(), span());
    return out;
  }

 private:
  DeviceContext* context_ = nullptr;
  T* data_ = nullptr;
  size_t size_ = 0, capacity_ = 0;
};

/// Scratch of one step: taken piece by piece, given back all at once. A step that needs more than there is adds blocks,
/// and reset() makes them one. Once warm, one allocation serves every later step, and pieces taken in the same order
/// have the same addresses.
class DeviceArena {
 public:
  explicit DeviceArena(DeviceContext& context) : context_(&context) {}
  ~DeviceArena();
  DeviceArena(const DeviceArena&) = delete;
  DeviceArena& operator=(const DeviceArena&) = delete;

  /// Undefined contents, valid until reset().
  template <class T>
  DeviceSpan<T> take(size_t count, const char* what) {
    return {static_cast<T*>(take_bytes(count * sizeof(T), what)), count};
  }
  template <class T>
  DeviceSpan<T> take_zeroed(size_t count, const char* what) {
    const DeviceSpan<T> span = take<T>(count, what);
    fill_zero(*context_, span);
    return span;
  }
  /// Gives every piece and the memory itself back.
  void release();
  /// Gives every piece back. Work still running on the stream may go on with them: later work waits for it.
  void reset();
  DeviceContext& context() const { return *context_; }

 private:
  struct Block {
    unsigned char* data;
    uint64_t bytes;
  };
  void* take_bytes(uint64_t bytes, const char* what);
  void add_block(uint64_t bytes, const char* what);
  DeviceContext* context_;
  std::vector<Block> blocks_;  ///< pieces come from the last one
  uint64_t used_ = 0;          ///< bytes of the last block
  uint64_t taken_ = 0;         ///< bytes of all pieces
  uint64_t held_ = 0;          ///< bytes of all blocks
};

/// Host memory that a device copies to without a detour.
class PinnedMemory {
 public:
  PinnedMemory(const DeviceContext& context, uint64_t bytes);
  ~PinnedMemory();
  PinnedMemory(const PinnedMemory&) = delete;
  PinnedMemory& operator=(const PinnedMemory&) = delete;
  void* data() const { return data_; }

 private:
  void* data_ = nullptr;
};

}  // namespace aligngs::cuda
