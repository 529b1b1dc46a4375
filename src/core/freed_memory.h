// Memory that was freed, for processes that end soon.
#pragma once

#include <cstdlib>  // defines __GLIBC__

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace aligngs {

/// Freed memory stays with the process, in one arena, for what it allocates next: the system then clears fewer pages.
/// An edit takes about a twentieth less time with it. Before threads start.
inline void keep_freed_memory() {
#if defined(__GLIBC__)
  constexpr int kLargest = 1 << 25;  // bytes; glibc takes no larger threshold
  constexpr int kNever = 1 << 30;
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kNever);
#endif
}

}  // namespace aligngs
