// Lets GCC compile a hot function several times and choose by the processor at run time.
#pragma once

#include "core/always_inline.h"

// Every version gives the same bits: contraction is off and no sum is reassociated, so only the number of
// pixels per instruction differs. Sanitizers run before the dynamic linker's resolvers could be instrumented.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(ALIGNGS_SCALAR_ONLY) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ALIGNGS_TARGET_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define ALIGNGS_TARGET_CLONES
#endif
