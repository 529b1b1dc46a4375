#include "core/free_memory.h"

#include <cstdlib>  // tells __GLIBC__

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace aligngs {

void give_back_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

void return_large_arrays_at_once() {
#ifdef __GLIBC__
  constexpr int kLarge = 1 << 20;  // bytes: where a page fault for each 4 KiB costs less than what the array is for
  mallopt(M_MMAP_THRESHOLD, kLarge);
#endif
}

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kLargest = 1 << 25;  // bytes; glibc takes no larger threshold
  constexpr int kNever = 1 << 30;    // bytes, more than a process frees at its end
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kNever);
#endif
}

}  // namespace aligngs
