#include "nn/cuda/emulation/host_cublas_lt.h"

#ifdef ALIGNGS_CUBLAS_LT

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/half.h"

namespace aligngs::cuda {
namespace {

constexpr size_t kWorkspaceBytes = 1024;  // what every algorithm here asks for
constexpr cublasStatus_t kGood = CUBLAS_STATUS_SUCCESS, kBad = CUBLAS_STATUS_INVALID_VALUE;

struct Operation {
  cublasComputeType_t compute;
  cudaDataType_t scale;
  cublasOperation_t left = CUBLAS_OP_N, right = CUBLAS_OP_N;
  cublasLtEpilogue_t epilogue = CUBLASLT_EPILOGUE_DEFAULT;
  const float* bias = nullptr;
};
struct Layout {
  cudaDataType type;
  uint64_t rows, columns;
  int64_t leading;
};
struct Preference {
  uint64_t workspace = 0;
  uint32_t reduction = CUBLASLT_REDUCTION_SCHEME_MASK, left = 256, right = 256, added = 256, result = 256;
};
/// Lies in the opaque numbers of an algorithm: what was promised about the addresses.
struct Promise {
  uint32_t left, right, result, bias;
};

template <class To, class From>
To& behind(From* opaque) {
  return *reinterpret_cast<To*>(opaque);
}
template <class T>
cublasStatus_t put(T& to, const void* from, size_t bytes) {
  if (bytes != sizeof(T)) return kBad;
  std::memcpy(&to, from, bytes);
  return kGood;
}
uint32_t alignment(const void* address) {
  const auto bits = reinterpret_cast<uintptr_t>(address);
  return bits == 0 ? 256u : static_cast<uint32_t>(std::min<uintptr_t>(bits & (~bits + 1), 256));
}

size_t version() { return CUBLAS_VERSION; }
const char* status_string(cublasStatus_t status) { return status == kBad ? "an invalid value" : "a status"; }
cublasStatus_t create(cublasLtHandle_t* handle) {
  *handle = reinterpret_cast<cublasLtHandle_t>(new HostCublasLt);
  return kGood;
}
cublasStatus_t destroy(cublasLtHandle_t handle) {
  delete &behind<HostCublasLt>(handle);
  return kGood;
}

cublasStatus_t create_operation(cublasLtMatmulDesc_t* made, cublasComputeType_t compute, cudaDataType_t scale) {
  *made = reinterpret_cast<cublasLtMatmulDesc_t>(new Operation{compute, scale});
  return kGood;
}
cublasStatus_t destroy_operation(cublasLtMatmulDesc_t made) {
  delete &behind<Operation>(made);
  return kGood;
}
cublasStatus_t set_operation(cublasLtMatmulDesc_t made, cublasLtMatmulDescAttributes_t attribute, const void* value,
                             size_t bytes) {
  Operation& o = behind<Operation>(made);
  switch (attribute) {
    case CUBLASLT_MATMUL_DESC_TRANSA:
      return put(o.left, value, bytes);
    case CUBLASLT_MATMUL_DESC_TRANSB:
      return put(o.right, value, bytes);
    case CUBLASLT_MATMUL_DESC_EPILOGUE:
      return put(o.epilogue, value, bytes);
    case CUBLASLT_MATMUL_DESC_BIAS_POINTER:
      return put(o.bias, value, bytes);
    default:
      return kBad;
  }
}

cublasStatus_t create_layout(cublasLtMatrixLayout_t* made, cudaDataType type, uint64_t rows, uint64_t columns,
                             int64_t leading) {
  if (leading < int64_t(rows)) return kBad;
  *made = reinterpret_cast<cublasLtMatrixLayout_t>(new Layout{type, rows, columns, leading});
  return kGood;
}
cublasStatus_t destroy_layout(cublasLtMatrixLayout_t made) {
  delete &behind<Layout>(made);
  return kGood;
}

cublasStatus_t create_preference(cublasLtMatmulPreference_t* made) {
  *made = reinterpret_cast<cublasLtMatmulPreference_t>(new Preference);
  return kGood;
}
cublasStatus_t destroy_preference(cublasLtMatmulPreference_t made) {
  delete &behind<Preference>(made);
  return kGood;
}
cublasStatus_t set_preference(cublasLtMatmulPreference_t made, cublasLtMatmulPreferenceAttributes_t attribute,
                              const void* value, size_t bytes) {
  Preference& p = behind<Preference>(made);
  switch (attribute) {
    case CUBLASLT_MATMUL_PREF_MAX_WORKSPACE_BYTES:
      return put(p.workspace, value, bytes);
    case CUBLASLT_MATMUL_PREF_REDUCTION_SCHEME_MASK:
      return put(p.reduction, value, bytes);
    case CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_A_BYTES:
      return put(p.left, value, bytes);
    case CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_B_BYTES:
      return put(p.right, value, bytes);
    case CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_C_BYTES:
      return put(p.added, value, bytes);
    case CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_D_BYTES:
      return put(p.result, value, bytes);
    default:
      return kBad;
  }
}

/// op(left) [m, k] op(right) [k, n] = result [m, n], operands of one type, sums and result in float32.
bool fits(const Operation& o, const Layout& left, const Layout& right, const Layout& result) {
  const bool turned = o.left == CUBLAS_OP_T, right_turned = o.right == CUBLAS_OP_T;
  const uint64_t m = turned ? left.columns : left.rows, k = turned ? left.rows : left.columns;
  return o.compute == CUBLAS_COMPUTE_32F && o.scale == CUDA_R_32F && result.type == CUDA_R_32F &&
         left.type == right.type && (left.type == CUDA_R_16BF || left.type == CUDA_R_32F) && m == result.rows &&
         k == (right_turned ? right.columns : right.rows) &&
         (right_turned ? right.rows : right.columns) == result.columns;
}

cublasStatus_t choose(cublasLtHandle_t handle, cublasLtMatmulDesc_t operation, cublasLtMatrixLayout_t left,
                      cublasLtMatrixLayout_t right, cublasLtMatrixLayout_t added, cublasLtMatrixLayout_t result,
                      cublasLtMatmulPreference_t preference, int wanted, cublasLtMatmulHeuristicResult_t results[],
                      int* found) {
  HostCublasLt& lt = behind<HostCublasLt>(handle);
  ++lt.choices;
  *found = 0;
  if (lt.choice != kGood) return lt.choice;
  const Operation& o = behind<Operation>(operation);
  const Preference& p = behind<Preference>(preference);
  if (wanted < 1 || added != result || p.added != p.result) return kBad;
  if (!fits(o, behind<Layout>(left), behind<Layout>(right), behind<Layout>(result))) return kBad;
  if (p.workspace < kWorkspaceBytes || p.reduction != CUBLASLT_REDUCTION_SCHEME_COMPUTE_TYPE)
    return CUBLAS_STATUS_NOT_SUPPORTED;
  const Promise promise{p.left, p.right, p.result, alignment(o.bias)};
  std::memcpy(results[0].algo.data, &promise, sizeof(promise));
  results[0].workspaceSize = kWorkspaceBytes;
  results[0].state = kGood;
  *found = 1;
  return kGood;
}

float element(const void* values, const Layout& l, bool turned, uint64_t row, uint64_t column) {
  if (turned) std::swap(row, column);
  const size_t i = size_t(column) * size_t(l.leading) + size_t(row);
  return l.type == CUDA_R_32F ? static_cast<const float*>(values)[i]
                              : bfloat16_to_float(static_cast<const uint16_t*>(values)[i]);
}

cublasStatus_t multiply(cublasLtHandle_t handle, cublasLtMatmulDesc_t operation, const void* alpha,
                        const void* left_values, cublasLtMatrixLayout_t left_layout, const void* right_values,
                        cublasLtMatrixLayout_t right_layout, const void* beta, const void* added_values,
                        cublasLtMatrixLayout_t added_layout, void* result_values, cublasLtMatrixLayout_t result_layout,
                        const cublasLtMatmulAlgo_t* algorithm, void* workspace, size_t workspace_bytes, cudaStream_t) {
  const HostCublasLt& lt = behind<HostCublasLt>(handle);
  if (lt.product != kGood) return lt.product;
  const Operation& o = behind<Operation>(operation);
  const Layout &left = behind<Layout>(left_layout), &right = behind<Layout>(right_layout),
               &result = behind<Layout>(result_layout);
  Promise promise;
  std::memcpy(&promise, algorithm->data, sizeof(promise));
  if (*static_cast<const float*>(alpha) != 1.0f || *static_cast<const float*>(beta) != 0.0f) return kBad;
  if (added_values != result_values || added_layout != result_layout || !fits(o, left, right, result)) return kBad;
  if (alignment(left_values) < promise.left || alignment(right_values) < promise.right ||
      alignment(result_values) < promise.result || alignment(o.bias) < promise.bias ||
      workspace_bytes < kWorkspaceBytes) {
    return kBad;
  }
  std::memset(workspace, 0xFF, workspace_bytes);
  const bool adds = (o.epilogue & CUBLASLT_EPILOGUE_BIAS) != 0, relu = (o.epilogue & CUBLASLT_EPILOGUE_RELU) != 0;
  if (adds && o.bias == nullptr) return kBad;
  const bool turned = o.left == CUBLAS_OP_T, right_turned = o.right == CUBLAS_OP_T;
  for (uint64_t c = 0; c < result.columns; ++c) {
    for (uint64_t r = 0; r < result.rows; ++r) {
      float sum = 0;
      for (uint64_t k = 0; k < (turned ? left.rows : left.columns); ++k) {
        sum += element(left_values, left, turned, r, k) * element(right_values, right, right_turned, k, c);
      }
      if (adds) sum += o.bias[r];
      static_cast<float*>(result_values)[size_t(c) * size_t(result.leading) + size_t(r)] =
          relu ? std::max(sum, 0.0f) : sum;
    }
  }
  return kGood;
}

}  // namespace

HostCublasLt& host_cublas_lt_of(cublasLtHandle_t handle) { return behind<HostCublasLt>(handle); }

CublasLtLibrary host_cublas_lt() {
  return {nullptr,
          {version, status_string, create, destroy, create_operation, destroy_operation, set_operation, create_layout,
           destroy_layout, create_preference, destroy_preference, set_preference, choose, multiply},
          {}};
}

}  // namespace aligngs::cuda

#endif
