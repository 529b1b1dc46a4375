// The part of cuBLASLt that products use, on the host and by the words of its header. A product's arguments are checked
// as strictly as the library may check them. The product is then formed by the definition.
#pragma once

#include "nn/cuda/cublas_lt.h"

#ifdef ALIGNGS_CUBLAS_LT

namespace aligngs::cuda {

/// The object behind a handle of the functions below.
struct HostCublasLt {
  int choices = 0;                                 ///< calls of the heuristic
  cublasStatus_t choice = CUBLAS_STATUS_SUCCESS;   ///< what it answers
  cublasStatus_t product = CUBLAS_STATUS_SUCCESS;  ///< what products answer, without forming them unless success
};
HostCublasLt& host_cublas_lt_of(cublasLtHandle_t handle);

CublasLtLibrary host_cublas_lt();

}  // namespace aligngs::cuda

#endif
