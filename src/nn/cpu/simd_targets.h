// The instruction sets for which the vector kernels are compiled. Include before any Highway
// header.
#pragma once

// The baseline x86-64-v2 has no PCLMUL or AES, which the kernels do not use; without this Highway
// would fall back to SSSE3, which lacks rounding. The variants of AVX-512 add nothing but build
// time here, and the scalable targets cannot hold vectors in arrays.
#define HWY_DISABLE_PCLMUL_AES 1
#define HWY_DISABLED_TARGETS (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
