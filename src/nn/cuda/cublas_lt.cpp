#include "nn/cuda/cublas_lt.h"

#ifdef ALIGNGS_CUBLAS_LT

#include "core/error.h"

namespace aligngs::cuda {

std::string CublasLtFunctions::find_in(const SharedLibrary& library) {
  std::string missing;
  const auto find = [&](const char* name, auto& function) {
    if (missing.empty() && !library.find(name, function)) missing = name;
  };
  find("cublasLtGetVersion", get_version);
  find("cublasLtGetStatusString", status_string);
  find("cublasLtCreate", create);
  find("cublasLtDestroy", destroy);
  find("cublasLtMatmulDescCreate", create_operation);
  find("cublasLtMatmulDescDestroy", destroy_operation);
  find("cublasLtMatmulDescSetAttribute", set_operation);
  find("cublasLtMatrixLayoutCreate", create_layout);
  find("cublasLtMatrixLayoutDestroy", destroy_layout);
  find("cublasLtMatmulPreferenceCreate", create_preference);
  find("cublasLtMatmulPreferenceDestroy", destroy_preference);
  find("cublasLtMatmulPreferenceSetAttribute", set_preference);
  find("cublasLtMatmulAlgoGetHeuristic", choose_algorithm);
  find("cublasLtMatmul", multiply);
  return missing;
}

std::vector<std::string> cublas_lt_names() {
  // Libraries of other major versions would be refused, so their half a gigabyte need not be loaded.
  return {"libcublasLt.so." + std::to_string(CUBLAS_VER_MAJOR), "libcublasLt.so"};
}

CublasLtLibrary load_cublas_lt(const std::vector<std::string>& names) {
  CublasLtFunctions functions;
  LibrarySearch search = find_library(names, [&](const SharedLibrary& library) -> std::string {
    functions = {};
    const std::string missing = functions.find_in(library);
    if (!missing.empty()) return "it has no " + missing;
    return version_refusal(functions.get_version(), CUBLAS_VER_MAJOR);
  });
  return {std::move(search.loaded), functions, std::move(search.reason)};
}

std::shared_ptr<CublasLt> CublasLt::start(CublasLtLibrary library, std::string& reason) {
  if (!library.usable()) {
    reason = library.reason;
    return nullptr;
  }
  cublasLtHandle_t handle = nullptr;
  const cublasStatus_t status = library.functions.create(&handle);
  if (status != CUBLAS_STATUS_SUCCESS) {
    reason = std::string("cuBLASLt does not start: ") + library.functions.status_string(status);
    return nullptr;
  }
  return std::shared_ptr<CublasLt>(new CublasLt(std::move(library), handle));
}

CublasLt::~CublasLt() { (void)functions().destroy(handle_); }

std::string CublasLt::name() const {
  const size_t version = functions().get_version();
  return "cuBLASLt " + std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

void CublasLt::check(cublasStatus_t status, const char* operation) const {
  if (status == CUBLAS_STATUS_SUCCESS) return;
  const bool resources = status == CUBLAS_STATUS_ALLOC_FAILED || status == CUBLAS_STATUS_NOT_INITIALIZED ||
                         status == CUBLAS_STATUS_ARCH_MISMATCH;
  throw Error({resources ? ErrorKind::kResources : ErrorKind::kFailed,
               std::string("cuBLASLt, ") + operation + ": " + functions().status_string(status),
               {},
               {},
               "use --device cpu"});
}

}  // namespace aligngs::cuda

#endif
