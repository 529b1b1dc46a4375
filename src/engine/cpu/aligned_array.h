// A growing array of plain numbers on a cache-line boundary whose new elements are not initialised.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

#include "core/huge_pages.h"

namespace aligngs::cpu {

/// Keeps its memory when it shrinks, so that a buffer sized every step allocates only while it still grows.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>, "contents are moved with memcpy");

 public:
  AlignedArray() = default;
  explicit AlignedArray(size_t n) { resize(n); }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](size_t i) { return data_.get()[i]; }
  const T& operator[](size_t i) const { return data_.get()[i]; }
  uint64_t capacity_bytes() const { return capacity_ * sizeof(T); }

  /// Old elements are kept; new ones have any value.
  void resize(size_t n) {
    if (n > capacity_) grow(n);
    size_ = n;
  }
  void fill(T value) { std::fill(data(), data() + size_, value); }
  /// Resizes and sets every element.
  void assign(size_t n, T value) {
    resize(n);
    fill(value);
  }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };

  void grow(size_t n) {
    const size_t wanted = capacity_ == 0 ? n : std::max(n, capacity_ + capacity_ / 4);
    const size_t alignment = wanted * sizeof(T) >= kHugePage ? kHugePage : 64;
    const size_t bytes = (wanted * sizeof(T) + alignment - 1) / alignment * alignment;
    std::unique_ptr<T, Free> fresh(static_cast<T*>(std::aligned_alloc(alignment, bytes)));
    if (!fresh) throw std::bad_alloc();
    ask_for_huge_pages(fresh.get(), bytes, HugePages::kWhenTouched);
    if (size_ > 0) std::memcpy(static_cast<void*>(fresh.get()), data_.get(), size_ * sizeof(T));
    data_ = std::move(fresh);
    capacity_ = bytes / sizeof(T);
  }

  std::unique_ptr<T, Free> data_;
  size_t size_ = 0, capacity_ = 0;
};

}  // namespace aligngs::cpu
