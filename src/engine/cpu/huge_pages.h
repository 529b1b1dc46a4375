// Pages of 2 MB for arrays that other modules allocate; AlignedArray asks for its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace aligngs::cpu {

/// Asks the system to back a large vector, already filled, with pages of 2 MB. Rows are read in gaps and pixels by
/// tiles; with 4 kB pages both would miss the TLB. A wish: where the system declines, nothing changes.
inline void ask_for_huge_pages(std::vector<float>& values) {
#ifdef __linux__
  constexpr uintptr_t kHugePage = uintptr_t(1) << 21;
  constexpr int kCollapse = 25;  // MADV_COLLAPSE of Linux 6.1, which older headers lack: at once, not some time later
  const uintptr_t begin = reinterpret_cast<uintptr_t>(values.data());
  const uintptr_t first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const uintptr_t last = (begin + values.size() * sizeof(float)) / kHugePage * kHugePage;
  if (values.empty() || first >= last) return;
  void* pages = reinterpret_cast<void*>(first);
  madvise(pages, last - first, MADV_HUGEPAGE);
  madvise(pages, last - first, kCollapse);
#else
  static_cast<void>(values);
#endif
}

}  // namespace aligngs::cpu
