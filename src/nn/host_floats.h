// Memory of the host for the floats of a tensor.
#pragma once

#include <cstddef>

namespace aligngs::nn {

/// A fixed number of floats, zero at first, on a boundary of 64 bytes. Large arrays are pages that the system clears when
/// they are touched first, by whichever thread does: nobody fills them with zeros beforehand. Throws std::bad_alloc.
class HostFloats {
 public:
  HostFloats() = default;
  explicit HostFloats(size_t count);
  ~HostFloats() { release(); }
  HostFloats(HostFloats&& other) noexcept;
  HostFloats& operator=(HostFloats&& other) noexcept;
  HostFloats(const HostFloats&) = delete;
  HostFloats& operator=(const HostFloats&) = delete;

  float* data() const { return floats_; }
  size_t size() const { return count_; }
  void release();

 private:
  float* floats_ = nullptr;
  size_t count_ = 0;
  void* pages_ = nullptr;  ///< of a large array; null: from the heap
  size_t page_bytes_ = 0;
};

}  // namespace aligngs::nn
