// Marks small maths so that nvcc compiles it for the device as well; empty for a C++ compiler.
#pragma once

#ifdef __CUDACC__
#define ALIGNGS_HD __host__ __device__
#else
#define ALIGNGS_HD
#endif
