// Pages of 2 MB for large arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace aligngs {

constexpr size_t kHugePage = size_t(1) << 21;  // bytes, on x86-64

/// When the system backs an array with huge pages.
enum class HugePages {
  kWhenTouched,  ///< as pages are written for the first time: for an array that nothing was written to
  kAtOnce        ///< now, by copying: for an array that is filled
};

/// Asks the system to back an array with pages of 2 MB, as far as whole ones lie in it. The system clears such a page in
/// one go instead of 512 times, and reads in random order do not miss the TLB. A wish: where the system declines, nothing
/// changes.
inline void ask_for_huge_pages(void* array, size_t bytes, HugePages when) {
#ifdef __linux__
  constexpr int kCollapse = 25;  // MADV_COLLAPSE of Linux 6.1, which older headers lack
  const uintptr_t begin = reinterpret_cast<uintptr_t>(array);
  const uintptr_t first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const uintptr_t last = (begin + bytes) / kHugePage * kHugePage;
  if (array == nullptr || first >= last) return;
  void* pages = reinterpret_cast<void*>(first);
  madvise(pages, last - first, MADV_HUGEPAGE);
  if (when == HugePages::kAtOnce) madvise(pages, last - first, kCollapse);
#else
  static_cast<void>(array);
  static_cast<void>(bytes);
  static_cast<void>(when);
#endif
}

/// The same for a vector that is filled, at once.
inline void ask_for_huge_pages(std::vector<float>& values) {
  ask_for_huge_pages(values.data(), values.size() * sizeof(float), HugePages::kAtOnce);
}

}  // namespace aligngs
