// NVIDIA's cuBLASLt, loaded at run time where it is installed. Empty where the toolkit that the program is built with
// has no cublasLt.h.
#pragma once

#if __has_include(<cublasLt.h>)
#define ALIGNGS_CUBLAS_LT 1

#include <cublasLt.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nn/cuda/shared_library.h"

namespace aligngs::cuda {

/// The functions of the library that products need.
struct CublasLtFunctions {
  decltype(&cublasLtGetVersion) get_version = nullptr;
  decltype(&cublasLtGetStatusString) status_string = nullptr;
  decltype(&cublasLtCreate) create = nullptr;
  decltype(&cublasLtDestroy) destroy = nullptr;
  decltype(&cublasLtMatmulDescCreate) create_operation = nullptr;
  decltype(&cublasLtMatmulDescDestroy) destroy_operation = nullptr;
  decltype(&cublasLtMatmulDescSetAttribute) set_operation = nullptr;
  decltype(&cublasLtMatrixLayoutCreate) create_layout = nullptr;
  decltype(&cublasLtMatrixLayoutDestroy) destroy_layout = nullptr;
  decltype(&cublasLtMatmulPreferenceCreate) create_preference = nullptr;
  decltype(&cublasLtMatmulPreferenceDestroy) destroy_preference = nullptr;
  decltype(&cublasLtMatmulPreferenceSetAttribute) set_preference = nullptr;
  decltype(&cublasLtMatmulAlgoGetHeuristic) choose_algorithm = nullptr;
  decltype(&cublasLtMatmul) multiply = nullptr;

  /// Names the first function that the library lacks; empty when it has them all.
  std::string find_in(const SharedLibrary& library);
};

/// The names to try: that of the headers' version first.
std::vector<std::string> cublas_lt_names();

struct CublasLtLibrary {
  std::unique_ptr<SharedLibrary> loaded;  ///< null: `reason` says why, or the functions are the program's own (tests)
  CublasLtFunctions functions;
  std::string reason;
  bool usable() const { return reason.empty(); }
};

/// Loads the library, of the headers' major version and with every function; needs no device.
CublasLtLibrary load_cublas_lt(const std::vector<std::string>& names);

/// The library, started for the device that is current in the calling thread.
class CublasLt {
 public:
  /// Null, with a reason, when the library is not usable or does not start.
  static std::shared_ptr<CublasLt> start(CublasLtLibrary library, std::string& reason);
  ~CublasLt();
  CublasLt(const CublasLt&) = delete;
  CublasLt& operator=(const CublasLt&) = delete;

  const CublasLtFunctions& functions() const { return library_.functions; }
  cublasLtHandle_t handle() const { return handle_; }
  /// For messages: the library and its version.
  std::string name() const;
  /// Throws Error{kResources} when the library is out of memory or its device is gone, else Error{kFailed}.
  void check(cublasStatus_t status, const char* operation) const;

 private:
  CublasLt(CublasLtLibrary library, cublasLtHandle_t handle) : library_(std::move(library)), handle_(handle) {}
  CublasLtLibrary library_;
  cublasLtHandle_t handle_;
};

}  // namespace aligngs::cuda

#endif
