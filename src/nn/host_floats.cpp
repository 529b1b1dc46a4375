#include "nn/host_floats.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

#include "core/huge_pages.h"

namespace aligngs::nn {
namespace {

constexpr size_t kAlignment = 64;         // bytes: a cache line, and a vector of AVX-512
constexpr size_t kLarge = 2 * kHugePage;  // bytes: at least one page of 2 MB lies in it wherever it begins

}  // namespace

HostFloats::HostFloats(size_t count) : count_(count) {
  if (count == 0) return;
  const size_t bytes = (count * sizeof(float) + kAlignment - 1) / kAlignment * kAlignment;
#ifdef __linux__
  if (bytes >= kLarge) {
    page_bytes_ = bytes + kHugePage;  // so that the array can begin with a page of 2 MB; the rest is never touched
    pages_ = mmap(nullptr, page_bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages_ == MAP_FAILED) {
      pages_ = nullptr;
      throw std::bad_alloc();
    }
    const uintptr_t first = (reinterpret_cast<uintptr_t>(pages_) + kHugePage - 1) / kHugePage * kHugePage;
    floats_ = reinterpret_cast<float*>(first);
    ask_for_huge_pages(floats_, bytes, HugePages::kWhenTouched);
    return;
  }
#endif
  floats_ = static_cast<float*>(std::aligned_alloc(kAlignment, bytes));
  if (!floats_) throw std::bad_alloc();
  std::memset(floats_, 0, bytes);
}

HostFloats::HostFloats(HostFloats&& other) noexcept { *this = std::move(other); }

HostFloats& HostFloats::operator=(HostFloats&& other) noexcept {
  std::swap(floats_, other.floats_);
  std::swap(count_, other.count_);
  std::swap(pages_, other.pages_);
  std::swap(page_bytes_, other.page_bytes_);
  if (this != &other) other.release();
  return *this;
}

void HostFloats::release() {
#ifdef __linux__
  if (pages_) {
    munmap(pages_, page_bytes_);
    floats_ = nullptr;
  }
#endif
  std::free(floats_);
  floats_ = nullptr;
  pages_ = nullptr;
  count_ = page_bytes_ = 0;
}

}  // namespace aligngs::nn
