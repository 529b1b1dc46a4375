// For the body of a loop that is to be vectorised: the compiler must not decide against inlining it.
#pragma once

#if defined(__GNUC__)
#define ALIGNGS_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define ALIGNGS_ALWAYS_INLINE inline
#endif
